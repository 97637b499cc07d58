#include "sandglass/observe/msd.h"

#include <algorithm>
#include <cmath>

namespace sandglass {

void add_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, ExactSum& square,
                       ExactSum& fourth) {
  std::array<double, block_size> squares, fourths;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    for (std::size_t j = 0; j < count; ++j) {
      const double dx = (now.x[begin + j] - origin.x[begin + j]) * scale;
      const double dy = (now.y[begin + j] - origin.y[begin + j]) * scale;
      squares[j] = dx * dx + dy * dy;
      fourths[j] = squares[j] * squares[j];
    }
    square.add(ordered_sum({squares.data(), count}));
    fourth.add(ordered_sum({fourths.data(), count}));
  }
}

double displacement_scale(double lag) { return lag > 0 && lag < 1 ? std::ldexp(1.0, -std::ilogb(lag)) : 1.0; }

}  // namespace sandglass
