// Look-up of the disks near a point, in cells filled one disk at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandglass {

/// Cells of a periodic square, each a linked list of disks. Cells are at least `reach` wide, so that everything within
/// `reach` of a point lies in the 3 x 3 cells around it. Wide boxes get no more cells than there are disks.
class Grid {
 public:
  Grid(double box_length, double reach, std::size_t disk_count);

  /// Adds disk `id` (below disk_count, not yet added) at (x, y) in [0, L).
  void add(std::uint32_t id, double x, double y) {
    auto& head = heads_[static_cast<std::size_t>(cell(y)) * cells_ + static_cast<std::size_t>(cell(x))];
    next_[id] = head;
    head = id;
  }

  /// Calls `visit(id)` for every disk in the 3 x 3 cells around (x, y), each once, until it returns false.
  /// Returns whether all were visited.
  template <class Visit>
  bool visit_near(double x, double y, Visit&& visit) const {
    const std::int64_t column = cell(x), row = cell(y);
    // In a box of fewer than three cells a neighbouring cell would be met twice.
    const std::int64_t first = cells_ < 3 ? 0 : -1, last = cells_ < 2 ? 0 : 1;
    for (std::int64_t dy = first; dy <= last; ++dy) {
      for (std::int64_t dx = first; dx <= last; ++dx) {
        for (std::uint32_t id = heads_[wrapped(row + dy) * cells_ + wrapped(column + dx)]; id != none; id = next_[id]) {
          if (!visit(id)) return false;
        }
      }
    }
    return true;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  [[nodiscard]] std::int64_t cell(double coordinate) const {
    return std::min(static_cast<std::int64_t>(coordinate * per_length_), static_cast<std::int64_t>(cells_) - 1);
  }
  [[nodiscard]] std::size_t wrapped(std::int64_t index) const {
    const auto count = static_cast<std::int64_t>(cells_);
    return static_cast<std::size_t>(index < 0 ? index + count : index >= count ? index - count : index);
  }

  std::size_t cells_;  ///< per side
  double per_length_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace sandglass
