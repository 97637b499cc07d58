// Who may touch whom soon: neighbour lists over a grid of list centres.
#pragma once

#include <cmath>
#include <cstdint>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/record.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Every disk has a list centre, where it stood when its list was made. Two disks are in each other's lists exactly
/// when their list centres are closer than R_i + R_j + skin. A disk's list expires when it has moved skin/2 from its
/// centre; until then no disk outside the list can touch it. Lists are symmetric and hold slots.
class Neighbours {
 public:
  Neighbours() = default;
  Neighbours(std::size_t size, const Box& box, double skin, double cell_size)
      : box_(box), skin_(skin), leash_(skin / 2 - 1e-9), lists_(size * stride_) {
    const double cells = std::floor(box.length / cell_size);
    side_ = cells < 1 ? 1 : cells > 32768 ? 32768 : static_cast<std::int32_t>(cells);
    inverse_cell_ = side_ / box.length;
    heads_ = Array<std::uint32_t>(static_cast<std::size_t>(side_) * side_);
    for (std::uint32_t& head : heads_) head = no_disk;
  }

  [[nodiscard]] double skin() const { return skin_; }

  /// How far a disk may move from its list centre: half the skin, less room for rounding.
  [[nodiscard]] double leash() const { return leash_; }

  [[gnu::always_inline]] std::uint32_t* list(std::uint32_t slot) { return &lists_[std::size_t{slot} * stride_]; }
  [[gnu::always_inline]] const std::uint32_t* list(std::uint32_t slot) const {
    return &lists_[std::size_t{slot} * stride_];
  }

  void place(std::uint32_t slot, ColdRecord* cold) {
    ColdRecord& disk = cold[slot];
    disk.cell = static_cast<std::uint32_t>(cell_index(disk.centre_y) * side_ + cell_index(disk.centre_x));
    disk.cell_next = heads_[disk.cell];
    heads_[disk.cell] = slot;
  }

  void displace(std::uint32_t slot, ColdRecord* cold) {
    std::uint32_t* link = &heads_[cold[slot].cell];
    while (*link != slot) link = &cold[*link].cell_next;
    *link = cold[slot].cell_next;
  }

  [[gnu::always_inline]] void add(std::uint32_t slot, std::uint32_t other, Record* records) {
    if (records[slot].neighbour_count == stride_) [[unlikely]]
      widen();
    list(slot)[records[slot].neighbour_count++] = other;
  }

  [[gnu::always_inline]] void remove(std::uint32_t slot, std::uint32_t other, Record* records) {
    std::uint32_t* const neighbours = list(slot);
    std::uint32_t i = 0;
    while (neighbours[i] != other) ++i;
    neighbours[i] = neighbours[--records[slot].neighbour_count];
  }

  /// Whether two disks belong in each other's lists.
  [[gnu::always_inline]] bool listed(const Record* records, const ColdRecord* cold, std::uint32_t a,
                                     std::uint32_t b) const {
    const double dx = box_.nearest(cold[b].centre_x - cold[a].centre_x);
    const double dy = box_.nearest(cold[b].centre_y - cold[a].centre_y);
    const double range = records[a].radius + records[b].radius + skin_;
    return dx * dx + dy * dy < range * range;
  }

  /// Calls visit(slot) for every disk whose list centre is within `radius` of (x, y), and for some farther ones.
  /// Returns whether that was every disk there is.
  template <class Visit>
  [[gnu::always_inline]] bool visit_near(double x, double y, double radius, const ColdRecord* cold,
                                         Visit&& visit) const {
    auto range = [&](double position, std::int32_t& first, std::int32_t& count) {
      first = static_cast<std::int32_t>(std::floor((position - radius) * inverse_cell_ - 1e-6));
      const auto last = static_cast<std::int32_t>(std::floor((position + radius) * inverse_cell_ + 1e-6));
      count = last - first + 1 < side_ ? last - first + 1 : side_;
    };
    std::int32_t first_x = 0, first_y = 0, count_x = 0, count_y = 0;
    range(x, first_x, count_x);
    range(y, first_y, count_y);
    for (std::int32_t j = 0; j < count_y; ++j) {
      const std::int32_t row = wrapped(first_y + j) * side_;
      for (std::int32_t i = 0; i < count_x; ++i)
        for (std::uint32_t slot = heads_[row + wrapped(first_x + i)]; slot != no_disk; slot = cold[slot].cell_next)
          visit(slot);
    }
    return count_x == side_ && count_y == side_;
  }

  [[nodiscard]] std::size_t bytes() const { return lists_.bytes() + heads_.bytes(); }

 private:
  [[nodiscard]] std::int32_t cell_index(double position) const {
    const auto cell = static_cast<std::int32_t>(position * inverse_cell_);
    return cell < side_ ? cell : side_ - 1;
  }

  [[nodiscard]] std::int32_t wrapped(std::int32_t cell) const {
    while (cell < 0) cell += side_;
    while (cell >= side_) cell -= side_;
    return cell;
  }

  // A list is full (a big disk among small ones): give every list more room.
  [[gnu::noinline]] void widen() {
    const std::uint32_t wider = stride_ + 8;
    const std::size_t size = lists_.size() / stride_;
    Array<std::uint32_t> lists(size * wider);
    for (std::size_t slot = 0; slot < size; ++slot)
      for (std::uint32_t i = 0; i < stride_; ++i) lists[slot * wider + i] = lists_[slot * stride_ + i];
    lists_ = std::move(lists);
    stride_ = wider;
  }

  Box box_{1, {}};
  double skin_ = 0, leash_ = 0;
  std::uint32_t stride_ = 16;  // room in each list
  Array<std::uint32_t> lists_;
  std::int32_t side_ = 1;  // cells along one side of the box
  double inverse_cell_ = 1;
  Array<std::uint32_t> heads_;  // first slot in each cell
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
