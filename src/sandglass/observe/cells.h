// The disks of one frame in cells, to find who is near whom.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace sandglass {

/// Wrapped positions in square cells of at least `side`; disks are named by their place in `x` and `y`.
class Cells {
 public:
  Cells(std::span<const double> x, std::span<const double> y, double box_length, double side);

  struct Neighbour {
    std::uint32_t id;
    double dx, dy;  ///< nearest image, from the disk asked about
    [[nodiscard]] double squared() const { return dx * dx + dy * dy; }
  };

  /// All other disks in the (2 rings + 1)^2 cells around the cell of `id`, into `found`. Complete up to the returned
  /// distance; infinity when these are all disks there are.
  double collect(std::uint32_t id, int rings, std::vector<Neighbour>& found) const;

  /// The disks from cell to cell. Who is near whom stands near each other in it.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return sorted_; }

  /// Calls visit(a, b, (distance)^2) once for every pair of disks closer than `range` <= L/2, order()[a] and
  /// order()[b], at their nearest images. The order of the pairs is a function of the positions alone.
  template <class Visit>
  void for_each_pair(double range, Visit&& visit) const;

 private:
  [[nodiscard]] int cell(double coordinate) const;
  void append(std::uint32_t id, std::size_t first, std::size_t last, std::vector<Neighbour>& found) const;

  double box_length_;
  int per_side_;
  std::vector<double> x_, y_;
  std::vector<std::uint32_t> first_;  ///< start of each cell in `sorted_`, and the end
  std::vector<std::uint32_t> sorted_;
  std::vector<double> sorted_x_, sorted_y_;
};

template <class Visit>
void Cells::for_each_pair(double range, Visit&& visit) const {
  const double squared_range = range * range;
  // Who is in range cannot be foretold: gathered first, without a branch, then visited.
  struct Near {
    std::size_t place;
    double squared;
  };
  std::array<Near, 64> near;
  const auto between = [&](std::size_t a, std::size_t begin, std::size_t end, double shift_x, double shift_y) {
    const double x = sorted_x_[a] - shift_x, y = sorted_y_[a] - shift_y;
    while (begin < end) {
      const std::size_t stop = std::min(end, begin + near.size());
      std::size_t count = 0;
      for (; begin < stop; ++begin) {
        const double dx = sorted_x_[begin] - x, dy = sorted_y_[begin] - y, squared = dx * dx + dy * dy;
        near[count] = {begin, squared};
        count += squared < squared_range ? 1 : 0;
      }
      for (std::size_t k = 0; k < count; ++k) visit(a, near[k].place, near[k].squared);
    }
  };
  const int rings = static_cast<int>(std::ceil(range * per_side_ / box_length_));
  if (2 * rings + 1 > per_side_) {  // cells would meet themselves around the box: all pairs, each at its nearest image
    for (std::size_t a = 0; a < sorted_.size(); ++a) {
      for (std::size_t b = a + 1; b < sorted_.size(); ++b) {
        const double dx = sorted_x_[b] - sorted_x_[a], dy = sorted_y_[b] - sorted_y_[a];
        between(a, b, b + 1, -box_length_ * std::nearbyint(dx / box_length_),
                -box_length_ * std::nearbyint(dy / box_length_));
      }
    }
    return;
  }
  // Half of the cells around each: those to the right in its row and all of the rows above. Those of a row lie side by
  // side in memory, in two stretches where they reach around the box.
  for (int row = 0; row < per_side_; ++row) {
    for (int column = 0; column < per_side_; ++column) {
      const auto own = static_cast<std::size_t>(row * per_side_ + column);
      for (std::size_t a = first_[own]; a < first_[own + 1]; ++a) {
        between(a, a + 1, first_[own + 1], 0, 0);
        for (int dy = 0; dy <= rings; ++dy) {
          const int around_y = (row + dy) / per_side_;
          const int base = (row + dy - around_y * per_side_) * per_side_;
          // The columns from `begin` to `end` once around the box by `around_x`.
          const auto stretch = [&](int begin, int end, int around_x) {
            if (begin < end)
              between(a, first_[static_cast<std::size_t>(base + begin)], first_[static_cast<std::size_t>(base + end)],
                      around_x * box_length_, around_y * box_length_);
          };
          const int begin = dy == 0 ? column + 1 : column - rings, end = column + rings + 1;
          stretch(begin + per_side_, per_side_, -1);
          stretch(std::max(begin, 0), std::min(end, per_side_), 0);
          stretch(std::max(begin - per_side_, 0), end - per_side_, 1);
        }
      }
    }
  }
}

}  // namespace sandglass
