#include "sandglass/observe/cells.h"

#include <limits>

namespace sandglass {

Cells::Cells(std::span<const double> x, std::span<const double> y, double box_length, double side)
    : box_length_(box_length) {
  // No more cells than disks: empty ones only cost memory.
  const double most = std::max(1.0, std::sqrt(static_cast<double>(x.size())));
  per_side_ = static_cast<int>(std::clamp(std::floor(box_length / side), 1.0, most));
  auto wrapped = [&](double c) { return c - box_length * std::floor(c / box_length); };
  std::vector<std::uint32_t> cell_of(x.size());
  first_.assign(static_cast<std::size_t>(per_side_ * per_side_) + 1, 0);
  x_.resize(x.size());
  y_.resize(x.size());
  for (std::size_t id = 0; id < x.size(); ++id) {
    x_[id] = wrapped(x[id]);
    y_[id] = wrapped(y[id]);
    cell_of[id] = static_cast<std::uint32_t>(cell(y_[id]) * per_side_ + cell(x_[id]));
    ++first_[cell_of[id] + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  sorted_.resize(x.size());
  for (std::uint32_t id = 0; id < x.size(); ++id) sorted_[next[cell_of[id]]++] = id;
  for (const std::uint32_t id : sorted_) {
    sorted_x_.push_back(x_[id]);
    sorted_y_.push_back(y_[id]);
  }
}

int Cells::cell(double coordinate) const {
  return std::min(static_cast<int>(coordinate / box_length_ * per_side_), per_side_ - 1);
}

void Cells::append(std::uint32_t id, std::size_t first, std::size_t last, std::vector<Neighbour>& found) const {
  const double half = box_length_ / 2;
  auto nearest = [&](double d) {  // most are within half the box, which spares the division
    return std::fabs(d) <= half ? d : d - box_length_ * std::nearbyint(d / box_length_);
  };
  const double x = x_[id], y = y_[id];
  for (std::size_t k = first; k < last; ++k)
    if (sorted_[k] != id) found.push_back({sorted_[k], nearest(sorted_x_[k] - x), nearest(sorted_y_[k] - y)});
}

double Cells::collect(std::uint32_t id, int rings, std::vector<Neighbour>& found) const {
  found.clear();
  if (2 * rings + 1 >= per_side_) {
    append(id, 0, sorted_.size(), found);
    return std::numeric_limits<double>::infinity();
  }
  const int column = cell(x_[id]), row = cell(y_[id]);
  auto wrapped = [&](int c) { return (c + per_side_) % per_side_; };
  for (int dy = -rings; dy <= rings; ++dy) {
    for (int dx = -rings; dx <= rings; ++dx) {
      const auto c = static_cast<std::size_t>(wrapped(row + dy) * per_side_ + wrapped(column + dx));
      append(id, first_[c], first_[c + 1], found);
    }
  }
  return rings * box_length_ / per_side_;
}

}  // namespace sandglass
