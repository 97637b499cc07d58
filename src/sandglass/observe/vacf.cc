#include "sandglass/observe/vacf.h"

#include <algorithm>

namespace sandglass {

void add_velocity_products(const Snapshot& origin, const Snapshot& now, Range range, ExactSum& sum) {
  std::array<double, block_size> products;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    for (std::size_t j = 0; j < count; ++j) {
      products[j] = now.vx[begin + j] * origin.vx[begin + j] + now.vy[begin + j] * origin.vy[begin + j];
    }
    sum.add(ordered_sum({products.data(), count}));
  }
}

}  // namespace sandglass
