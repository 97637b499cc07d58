#include "sandglass/observe/msd.h"

#include <algorithm>
#include <cmath>

#include "sandglass/observe/portable.h"
#include "sandglass/observe/van_hove.h"

namespace sandglass {
namespace {

/// Squares and fourth powers of `count` displacements; how many squares are at most `limit`.
SANDGLASS_WIDE std::uint64_t powers(const double* x, const double* x0, const double* y, const double* y0,
                                    std::size_t count, double scale, double limit, double* squares, double* fourths) {
  std::uint64_t within = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const double dx = (x[j] - x0[j]) * scale;
    const double dy = (y[j] - y0[j]) * scale;
    squares[j] = dx * dx + dy * dy;
    fourths[j] = squares[j] * squares[j];
    within += squares[j] <= limit ? 1 : 0;
  }
  return within;
}

}  // namespace

void add_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, double overlap_length,
                       DisplacementSums& sums) {
  std::array<double, block_size> squares, fourths;
  const double limit = overlap_length * overlap_length * scale * scale, unscaled = 1 / (scale * scale);
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    sums.overlapping += powers(&now.x[begin], &origin.x[begin], &now.y[begin], &origin.y[begin], count, scale, limit,
                               squares.data(), fourths.data());
    sums.square.add(ordered_sum({squares.data(), count}));
    sums.fourth.add(ordered_sum({fourths.data(), count}));
    if (sums.by_distance == nullptr) continue;
    for (std::size_t j = 0; j < count; ++j) ++sums.by_distance[van_hove_bin(squares[j] * unscaled)];
  }
}

double displacement_scale(double lag) { return lag > 0 && lag < 1 ? std::ldexp(1.0, -std::ilogb(lag)) : 1.0; }

}  // namespace sandglass
