#include "sandglass/dynamics/spatial_order.h"

#include <algorithm>
#include <utility>

namespace sandglass {
namespace {

// Distance along the Hilbert curve of order `bits` of the cell (x, y): from the coarsest quadrant down, each quadrant
// turns and mirrors what is inside it.
std::uint64_t hilbert_index(std::uint32_t x, std::uint32_t y, int bits) {
  std::uint64_t index = 0;
  for (int level = bits - 1; level >= 0; --level) {
    const std::uint32_t right = x >> level & 1, up = y >> level & 1;
    index = index << 2 | ((3 * right) ^ up);
    if (up == 0) {
      if (right == 1) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return index;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(const State& state) {
  int bits = 1;
  while (bits < 16 && (std::size_t{1} << (2 * bits)) < state.size()) ++bits;
  const double cells = static_cast<double>(1 << bits);
  auto cell = [&](double position) {
    const double scaled = position / state.box_length * cells;
    return static_cast<std::uint32_t>(scaled < 0 ? 0 : scaled < cells ? scaled : cells - 1);
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(state.size());
  for (std::uint32_t id = 0; id < state.size(); ++id)
    keys[id] = {hilbert_index(cell(state.disks[id].x), cell(state.disks[id].y), bits), id};
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(state.size());
  for (std::size_t slot = 0; slot < keys.size(); ++slot) order[slot] = keys[slot].second;
  return order;
}

}  // namespace sandglass
