#include "sandglass/observe/cage.h"

#include <algorithm>
#include <utility>

#include "sandglass/observe/cells.h"

namespace sandglass {

Cages cages_of(const Snapshot& snapshot, const Population& population) {
  const auto& radius = population.mixture.radius;
  const std::size_t n = population.size();
  const auto species = [&](std::uint32_t i) { return i < population.small_count ? small : big; };
  const double range = std::min(neighbour_reach * 2 * std::max(radius[small], radius[big]), population.box_length / 2);
  const Cells cells(snapshot.x, snapshot.y, population.box_length, range / 2);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  Cages cages;
  cages.first.assign(n + 1, 0);
  cells.for_each_pair(range, [&](std::size_t a, std::size_t b, double squared) {
    const std::uint32_t i = cells.order()[a], j = cells.order()[b];
    const double reach = neighbour_reach * (radius[species(i)] + radius[species(j)]);
    if (squared >= reach * reach) return;
    pairs.emplace_back(i, j);
    ++cages.first[i + 1], ++cages.first[j + 1];
  });
  for (std::size_t i = 0; i < n; ++i) cages.first[i + 1] += cages.first[i];
  cages.neighbour.resize(cages.first[n]);
  std::vector<std::uint32_t> next(cages.first.begin(), cages.first.end() - 1);
  for (const auto& [i, j] : pairs) {
    cages.neighbour[next[i]++] = j;
    cages.neighbour[next[j]++] = i;
  }
  return cages;
}

RelativeDisplacements relative_displacements(const Snapshot& origin, const Snapshot& now, const Cages& cages) {
  const std::size_t n = origin.x.size();
  std::vector<double> dx(n), dy(n);
  for (std::size_t i = 0; i < n; ++i) {
    dx[i] = now.x[i] - origin.x[i];
    dy[i] = now.y[i] - origin.y[i];
  }
  RelativeDisplacements relative{dx, dy};
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t begin = cages.first[i], end = cages.first[i + 1];
    if (begin == end) continue;
    double x = 0, y = 0;
    for (std::uint32_t k = begin; k < end; ++k) {
      x += dx[cages.neighbour[k]];
      y += dy[cages.neighbour[k]];
    }
    relative.x[i] -= x / (end - begin);
    relative.y[i] -= y / (end - begin);
  }
  return relative;
}

void add_squares(const RelativeDisplacements& displacements, Range range, double scale, ExactSum& square) {
  std::array<double, block_size> squares;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    for (std::size_t j = 0; j < count; ++j) {
      const double dx = displacements.x[begin + j] * scale, dy = displacements.y[begin + j] * scale;
      squares[j] = dx * dx + dy * dy;
    }
    square.add(ordered_sum({squares.data(), count}));
  }
}

}  // namespace sandglass
