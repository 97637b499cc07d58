#include "sandglass/observe/vacf.h"

#include <algorithm>

namespace sandglass {
namespace {

template <class Product>
void add_products(Range range, ExactSum& sum, Product&& product) {
  std::array<double, block_size> products;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    for (std::size_t j = 0; j < count; ++j) products[j] = product(begin + j);
    sum.add(ordered_sum({products.data(), count}));
  }
}

}  // namespace

void add_velocity_products(const Snapshot& origin, const Snapshot& now, Range range, ExactSum& sum) {
  add_products(range, sum, [&](std::size_t i) { return now.vx[i] * origin.vx[i] + now.vy[i] * origin.vy[i]; });
}

void add_velocity_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, ExactSum& sum) {
  add_products(range, sum, [&](std::size_t i) {
    const double dx = (now.x[i] - origin.x[i]) * scale, dy = (now.y[i] - origin.y[i]) * scale;
    return origin.vx[i] * dx + origin.vy[i] * dy;
  });
}

}  // namespace sandglass
