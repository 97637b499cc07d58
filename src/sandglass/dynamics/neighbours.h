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

/// The memory of the lists and of the grid of their centres.
struct NeighbourTable {
  /// Lists are read by whole blocks: from their end to the end of the block they hold the slot `size`, of which the
  /// engine keeps a record that nothing ever touches.
  static constexpr std::uint32_t block = ColdRecord::listed_here;

  NeighbourTable() = default;
  /// Empty lists for all of `cold_`.
  NeighbourTable(Array<ColdRecord>& cold_, const Box& box, const Mixture& mixture_, double skin_, double cell_size)
      : mixture(mixture_),
        skin(skin_),
        nobody(static_cast<std::uint32_t>(cold_.size())),
        cold(cold_.begin()),
        more(cold_.size() * stride),
        grid(box.length, cell_size) {
    for (ColdRecord& disk : cold_)
      for (std::uint32_t& entry : disk.listed) entry = nobody;
    for (std::uint32_t& entry : more) entry = nobody;
  }

  Mixture mixture;
  double skin = 0;
  std::uint32_t nobody = 0;
  std::uint32_t stride = block;  // room for each list beyond its first block
  ColdRecord* cold = nullptr;    // has the first block
  Array<std::uint32_t> more;
  GridTable grid;
};

/// Every disk has a list centre, where it stood when its list was made. Two disks are in each other's lists exactly
/// when their list centres are closer than R_i + R_j + skin. A disk's list expires when it has moved skin/2 from its
/// centre; until then no disk outside the list can touch it. Lists are symmetric and hold slots.
/// Every thread has a Neighbours of its own on the one table.
class Neighbours {
 public:
  static constexpr std::uint32_t block = NeighbourTable::block;

  Neighbours() = default;
  explicit Neighbours(NeighbourTable& table)
      : mixture_(table.mixture),
        grid_(table.grid),
        skin_(table.skin),
        nobody_(table.nobody),
        stride_(table.stride),
        table_(&table),
        cold_(table.cold),
        more_(table.more.begin()) {}

  [[nodiscard]] const Grid& grid() const { return grid_; }
  [[nodiscard]] Grid& grid() { return grid_; }

  /// The farthest that the list centre of a listed disk may be; 1e-5: distances are taken in single precision.
  [[nodiscard]] double longest_range() const {
    return (1 + 1e-5) * std::fmax(range(mixture_.radius[big], big), range(mixture_.radius[small], small));
  }

  /// The tables may have moved.
  void refresh() {
    grid_.refresh();
    more_ = table_->more.begin();
    stride_ = table_->stride;
  }

  /// How far a disk may move from its list centre: half the skin, less room for what the grid rounds.
  [[nodiscard]] double leash() const {
    const double widest = range(mixture_.radius[big], big) + range(mixture_.radius[small], small);
    return skin_ / 2 - 1e-9 - 4 * grid_.unit() - 1e-6 * widest;
  }

  /// The first block of the list of a disk.
  [[gnu::always_inline]] const std::uint32_t* list(std::uint32_t slot) const { return cold_[slot].listed; }
  /// What lies beyond the first block.
  [[gnu::always_inline]] const std::uint32_t* more(std::uint32_t slot) const {
    return &more_[std::size_t{slot} * stride_];
  }
  /// From entry `first` on to the end of its block.
  [[gnu::always_inline]] const std::uint32_t* list_from(std::uint32_t slot, std::uint32_t first) const {
    return first < block ? list(slot) + first : more(slot) + (first - block);
  }
  /// Entry n.
  [[nodiscard]] std::uint32_t listed(std::uint32_t slot, std::uint32_t n) const { return *list_from(slot, n); }

  /// Gives a disk that has none a list around the centre `at`.
  void enter(std::uint32_t slot, FixedPoint at, Record* records) {
    const Grid::Slots found = find(at, records[slot]);
    for (std::uint32_t n = 0; n < found.count; ++n) {
      add(slot, found.first[n], records);
      add(found.first[n], slot, records);
    }
    grid_.place(slot, at, records[slot].species);
  }

  /// Makes the list of a disk anew around another centre; tell_others must follow. Where the tables are too small they
  /// are enlarged; but if they may not move (`fixed`), nothing is done and the answer is false.
  bool renew(std::uint32_t slot, FixedPoint old, FixedPoint at, Record* records, bool fixed = false) {
    grid_.displace(slot, old, records[slot].species);
    const Grid::Slots found = find(at, records[slot]);
    const std::uint32_t before = records[slot].neighbour_count;
    if (fixed && (found.count > room() || grid_.spare_lines() == 0)) [[unlikely]] {
      grid_.place(slot, old, records[slot].species);
      return false;
    }
    while (found.count > room()) [[unlikely]] widen();
    if (before + found.count > changes_.size()) [[unlikely]]
      changes_ = Array<std::uint32_t>(2 * (before + found.count));
    // Most stay. Who comes or goes is gathered first, without branches, since they cannot be foretold.
    std::uint32_t came = 0, gone = 0;
    for (std::uint32_t n = 0; n < found.count; ++n) {
      changes_[came] = found.first[n];
      came += !lists(slot, before, found.first[n]);
    }
    std::uint32_t* const goers = &changes_[came];
    for (std::uint32_t n = 0; n < before; ++n) {
      goers[gone] = listed(slot, n);
      gone += !holds(found.first, found.count, goers[gone]);
    }
    for (std::uint32_t n = 0; n < came + gone; ++n) prefetch(list(changes_[n])), prefetch(&records[changes_[n]]);
    for (std::uint32_t n = 0; n < block; ++n) entry(slot, n) = n < found.count ? found.first[n] : nobody_;
    const std::uint32_t longest = before > found.count ? before : found.count;
    for (std::uint32_t n = block; n < longest; ++n) entry(slot, n) = n < found.count ? found.first[n] : nobody_;
    records[slot].neighbour_count = static_cast<std::uint16_t>(found.count);
    grid_.place(slot, at, records[slot].species);
    came_ = came;
    gone_ = gone;
    return true;
  }

  /// Enters the disk whose list was made anew into the lists of those who came, and strikes it from those of who went.
  /// Their lists may be far from the processor, so it is well to do something else in between. False if one of them is
  /// full and may not move (`fixed`): then not everybody has been told, and no list must be used any more.
  [[nodiscard]] bool tell_others(std::uint32_t slot, Record* records, bool fixed) {
    for (std::uint32_t n = 0; n < gone_; ++n) remove(changes_[came_ + n], slot, records);
    for (std::uint32_t n = 0; n < came_; ++n) {
      if (fixed && records[changes_[n]].neighbour_count == room()) [[unlikely]]
        return false;
      add(changes_[n], slot, records);
    }
    return true;
  }

  /// Whether the list of a disk, whose list centre is `at`, names everybody whose list centre is within range, and
  /// nobody else.
  [[nodiscard]] bool complete(std::uint32_t slot, FixedPoint at, const Record& disk) {
    const Grid::Slots found = find(at, disk);  // the disk itself is among them
    if (found.count != disk.neighbour_count + 1u || found.count > room() + 1) return false;
    for (std::uint32_t n = 0; n < found.count; ++n)
      if (found.first[n] != slot && !lists(slot, disk.neighbour_count, found.first[n])) return false;
    return true;
  }

  /// Sees to it that a list may have so many entries. Other Neighbours must be told (refresh).
  void make_room(std::uint32_t entries) {
    refresh();
    while (entries > room()) widen();
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

  [[nodiscard]] std::uint32_t room() const { return block + stride_; }

  [[gnu::always_inline]] std::uint32_t& entry(std::uint32_t slot, std::uint32_t n) {
    return n < block ? cold_[slot].listed[n] : more_[std::size_t{slot} * stride_ + (n - block)];
  }

  /// Which of the first `count` entries of a block, or of all, equal `slot`.
  [[gnu::always_inline]] static unsigned lanes_of(const std::uint32_t* entries, std::uint32_t count,
                                                  std::uint32_t slot) {
    return equal_lanes(entries, slot) & ((1u << (count < block ? count : block)) - 1);
  }

  /// Whether `slot` is among the first `count` entries, which are read by whole blocks.
  [[gnu::always_inline]] static bool holds(const std::uint32_t* entries, std::uint32_t count, std::uint32_t slot) {
    unsigned lanes = lanes_of(entries, count, slot);
    for (std::uint32_t first = block; first < count; first += block)
      lanes |= lanes_of(entries + first, count - first, slot);
    return lanes != 0;
  }

  /// Whether the list of a disk, of `count` entries, names `other`.
  [[gnu::always_inline]] bool lists(std::uint32_t slot, std::uint32_t count, std::uint32_t other) const {
    unsigned lanes = lanes_of(list(slot), count, other);
    for (std::uint32_t first = block; first < count; first += block)
      lanes |= lanes_of(list_from(slot, first), count - first, other);
    return lanes != 0;
  }

  void add(std::uint32_t slot, std::uint32_t other, Record* records) {
    std::uint16_t& count = records[slot].neighbour_count;
    if (count == room()) [[unlikely]]
      widen();
    entry(slot, count++) = other;
  }

  void remove(std::uint32_t slot, std::uint32_t other, Record* records) {
    const std::uint32_t last = --records[slot].neighbour_count;
    std::uint32_t first = 0;
    unsigned lanes = equal_lanes(list(slot), other);
    while (lanes == 0) lanes = equal_lanes(list_from(slot, first += block), other);
    entry(slot, first + static_cast<std::uint32_t>(__builtin_ctz(lanes))) = listed(slot, last);
    entry(slot, last) = nobody_;
  }

  // A list is full (a big disk among small ones): give every list more room.
  [[gnu::noinline]] void widen() {
    const std::uint32_t wider = stride_ + block;
    const std::size_t size = table_->more.size() / stride_;
    Array<std::uint32_t> more(size * wider);
    for (std::size_t slot = 0; slot < size; ++slot)
      for (std::uint32_t i = 0; i < wider; ++i)
        more[slot * wider + i] = i < stride_ ? more_[slot * stride_ + i] : nobody_;
    table_->more = std::move(more);
    table_->stride = wider;
    refresh();
  }

  Mixture mixture_;
  Grid grid_;
  double skin_ = 0;
  std::uint32_t nobody_ = 0;
  std::uint32_t stride_ = block;
  NeighbourTable* table_ = nullptr;
  ColdRecord* cold_ = nullptr;
  std::uint32_t* more_ = nullptr;
  Array<std::uint32_t> changes_ = Array<std::uint32_t>(64);  // who came into the list made last, then who went
  std::uint32_t came_ = 0, gone_ = 0;
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
