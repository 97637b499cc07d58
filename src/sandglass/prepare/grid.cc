#include "sandglass/prepare/grid.h"

#include <cmath>

namespace sandglass {

Grid::Grid(double box_length, double reach, std::size_t disk_count) : next_(disk_count, none) {
  const double most = std::ceil(std::sqrt(static_cast<double>(disk_count)));
  cells_ = static_cast<std::size_t>(std::max(1.0, std::min(most, std::floor(box_length / reach))));
  per_length_ = static_cast<double>(cells_) / box_length;
  heads_.assign(cells_ * cells_, none);
}

}  // namespace sandglass
