// Who may touch whom soon: neighbour lists.
#pragma once

#include <cstdint>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/grid.h"
#include "sandglass/dynamics/record.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Every disk has a list centre, where it stood when its list was made. Two disks are in each other's lists exactly
/// when their list centres are closer than R_i + R_j + skin. A disk's list expires when it has moved skin/2 from its
/// centre; until then no disk outside the list can touch it. Lists are symmetric and hold slots.
class Neighbours {
 public:
  /// Lists are read by whole blocks: from their end to the end of the block they hold the slot `size`, of which the
  /// engine keeps a record that nothing ever touches.
  static constexpr std::uint32_t block = 8;

  Neighbours() = default;
  Neighbours(std::size_t size, const Box& box, const Mixture& mixture, double skin, double cell_size)
      : mixture_(mixture),
        grid_(box.length, cell_size),
        skin_(skin),
        nobody_(static_cast<std::uint32_t>(size)),
        lists_(size * stride_) {
    for (std::uint32_t& entry : lists_) entry = nobody_;
  }

  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// How far a disk may move from its list centre: half the skin, less room for what the grid rounds.
  [[nodiscard]] double leash() const {
    const double widest = range(mixture_.radius[big], big) + range(mixture_.radius[small], small);
    return skin_ / 2 - 1e-9 - 4 * grid_.unit() - 1e-6 * widest;
  }

  [[gnu::always_inline]] const std::uint32_t* list(std::uint32_t slot) const {
    return &lists_[std::size_t{slot} * stride_];
  }

  /// Gives a disk that has none a list around the centre `at`.
  void enter(std::uint32_t slot, FixedPoint at, Record* records) {
    const Grid::Slots found = find(at, records[slot]);
    for (std::uint32_t n = 0; n < found.count; ++n) {
      add(slot, found.first[n], records);
      add(found.first[n], slot, records);
    }
    grid_.place(slot, at, records[slot].species);
  }

  /// Makes the list of a disk anew around another centre, and enters it into or strikes it from the lists of those who
  /// come or go.
  void renew(std::uint32_t slot, FixedPoint old, FixedPoint at, Record* records) {
    grid_.displace(slot, old, records[slot].species);
    const Grid::Slots found = find(at, records[slot]);
    const std::uint32_t before = records[slot].neighbour_count;
    while (found.count > stride_) [[unlikely]] widen();
    if (before + found.count > changes_.size()) [[unlikely]]
      changes_ = Array<std::uint32_t>(2 * (before + found.count));
    // Most stay. Who comes or goes is gathered first, without branches, since they cannot be foretold.
    std::uint32_t* const mine = &lists_[std::size_t{slot} * stride_];
    std::uint32_t came = 0, gone = 0;
    for (std::uint32_t n = 0; n < found.count; ++n) {
      changes_[came] = found.first[n];
      came += !holds(mine, before, found.first[n]);
    }
    std::uint32_t* const goers = &changes_[came];
    for (std::uint32_t n = 0; n < before; ++n) {
      goers[gone] = mine[n];
      gone += !holds(found.first, found.count, mine[n]);
    }
    for (std::uint32_t n = 0; n < stride_; ++n) mine[n] = n < found.count ? found.first[n] : nobody_;
    records[slot].neighbour_count = static_cast<std::uint16_t>(found.count);
    for (std::uint32_t n = 0; n < gone; ++n) remove(goers[n], slot, records);
    for (std::uint32_t n = 0; n < came; ++n) add(changes_[n], slot, records);
    grid_.place(slot, at, records[slot].species);
  }

  /// Whether the list of a disk, whose list centre is `at`, names everybody whose list centre is within range, and
  /// nobody else.
  [[nodiscard]] bool complete(std::uint32_t slot, FixedPoint at, const Record& disk) {
    const Grid::Slots found = find(at, disk);  // the disk itself is among them
    if (found.count != disk.neighbour_count + 1u || found.count > stride_ + 1) return false;
    for (std::uint32_t n = 0; n < found.count; ++n)
      if (found.first[n] != slot && !holds(list(slot), disk.neighbour_count, found.first[n])) return false;
    return true;
  }

  /// Brings what renew will read nearer to the processor.
  [[gnu::always_inline]] void fetch(FixedPoint at, const Record& disk) const {
    grid_.fetch(at, range(disk.radius, big));
  }

 private:
  [[nodiscard]] double range(double radius, Species other) const { return radius + mixture_.radius[other] + skin_; }

  [[gnu::always_inline]] Grid::Slots find(FixedPoint at, const Record& disk) {
    return grid_.within(at, {range(disk.radius, small), range(disk.radius, big)});
  }

  /// Whether `slot` is among the first `count` entries, which are read by whole blocks.
  [[gnu::always_inline]] static bool holds(const std::uint32_t* entries, std::uint32_t count, std::uint32_t slot) {
    unsigned lanes = equal_lanes(entries, slot) & ((1u << (count < block ? count : block)) - 1);
    for (std::uint32_t first = block; first < count; first += block)
      lanes |= equal_lanes(entries + first, slot) & ((1u << (count - first < block ? count - first : block)) - 1);
    return lanes != 0;
  }

  void add(std::uint32_t slot, std::uint32_t other, Record* records) {
    std::uint16_t& count = records[slot].neighbour_count;
    if (count == stride_) [[unlikely]]
      widen();
    lists_[std::size_t{slot} * stride_ + count++] = other;
  }

  void remove(std::uint32_t slot, std::uint32_t other, Record* records) {
    std::uint32_t* const neighbours = &lists_[std::size_t{slot} * stride_];
    const std::uint32_t last = --records[slot].neighbour_count;
    std::uint32_t place = 0;
    unsigned lanes = equal_lanes(neighbours, other);
    while (lanes == 0) lanes = equal_lanes(neighbours + (place += block), other);
    place += static_cast<std::uint32_t>(__builtin_ctz(lanes));
    neighbours[place] = neighbours[last];
    neighbours[last] = nobody_;
  }

  // A list is full (a big disk among small ones): give every list more room.
  [[gnu::noinline]] void widen() {
    const std::uint32_t wider = stride_ + block;
    const std::size_t size = lists_.size() / stride_;
    Array<std::uint32_t> lists(size * wider);
    for (std::size_t slot = 0; slot < size; ++slot)
      for (std::uint32_t i = 0; i < wider; ++i)
        lists[slot * wider + i] = i < stride_ ? lists_[slot * stride_ + i] : nobody_;
    lists_ = std::move(lists);
    stride_ = wider;
  }

  Mixture mixture_;
  Grid grid_;
  double skin_ = 0;
  std::uint32_t nobody_ = 0;
  std::uint32_t stride_ = 2 * block;  // room in each list
  Array<std::uint32_t> lists_;
  Array<std::uint32_t> changes_ = Array<std::uint32_t>(64);
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
