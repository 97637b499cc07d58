// The disks of one frame in cells, to find who is near whom.
#pragma once

#include <algorithm>
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

  /// Calls visit(id, other, dx, dy, dx^2 + dy^2) once for every pair of disks closer than `range` <= L/2; (dx, dy) is
  /// the nearest image of `other` from `id`. The order of the pairs is a function of the positions alone.
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
  const auto between = [&](std::size_t a, std::size_t begin, std::size_t end, double shift_x, double shift_y) {
    const double x = sorted_x_[a] - shift_x, y = sorted_y_[a] - shift_y;
    for (std::size_t b = begin; b < end; ++b) {
      const double dx = sorted_x_[b] - x, dy = sorted_y_[b] - y, squared = dx * dx + dy * dy;
      if (squared < squared_range) visit(sorted_[a], sorted_[b], dx, dy, squared);
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
  // Half of the cells around each: those to the right in its row and all of the rows above.
  for (int row = 0; row < per_side_; ++row) {
    for (int column = 0; column < per_side_; ++column) {
      const auto own = static_cast<std::size_t>(row * per_side_ + column);
      for (std::size_t a = first_[own]; a < first_[own + 1]; ++a) between(a, a + 1, first_[own + 1], 0, 0);
      for (int dy = 0; dy <= rings; ++dy) {
        for (int dx = dy == 0 ? 1 : -rings; dx <= rings; ++dx) {
          const int r = row + dy, c = column + dx;
          const int wrapped_r = r % per_side_, wrapped_c = (c + per_side_) % per_side_;
          const auto other = static_cast<std::size_t>(wrapped_r * per_side_ + wrapped_c);
          const double shift_x = (c - wrapped_c) / per_side_ * box_length_;
          const double shift_y = (r - wrapped_r) / per_side_ * box_length_;
          for (std::size_t a = first_[own]; a < first_[own + 1]; ++a)
            between(a, first_[other], first_[other + 1], shift_x, shift_y);
        }
      }
    }
  }
}

}  // namespace sandglass
