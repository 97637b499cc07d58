// The disks of one frame in cells, to find who is near whom.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/frame.h"

namespace sandglass {

/// Wrapped positions of a frame in square cells of at least `side`.
class Cells {
 public:
  Cells(const Frame& frame, double box_length, double side);

  struct Neighbour {
    std::uint32_t id;
    double dx, dy;  ///< nearest image, from the disk asked about
    [[nodiscard]] double squared() const { return dx * dx + dy * dy; }
  };

  /// All other disks in the (2 rings + 1)^2 cells around the cell of `id`, into `found`. Complete up to the returned
  /// distance; infinity when these are all disks there are.
  double collect(std::uint32_t id, int rings, std::vector<Neighbour>& found) const;

 private:
  [[nodiscard]] int cell(double coordinate) const;
  void append(std::uint32_t id, std::size_t first, std::size_t last, std::vector<Neighbour>& found) const;

  double box_length_;
  int per_side_;
  std::vector<double> x_, y_;
  std::vector<std::uint32_t> first_;  ///< start of each cell in `sorted_`, and the end
  std::vector<std::uint32_t> sorted_;
};

}  // namespace sandglass
