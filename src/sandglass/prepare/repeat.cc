#include "sandglass/prepare/repeat.h"

#include <cmath>

#include "sandglass/prepare/periodic.h"

namespace sandglass {

State repeat_periodically(const State& tile, std::size_t per_side) {
  State whole = tile;
  whole.box_length = static_cast<double>(per_side) * tile.box_length;
  whole.disks.clear();
  whole.disks.reserve(tile.size() * per_side * per_side);
  for (const Species species : {small, big}) {
    for (std::size_t copy = 0; copy < per_side * per_side; ++copy) {
      const double left = static_cast<double>(copy % per_side) * tile.box_length;
      const double bottom = static_cast<double>(copy / per_side) * tile.box_length;
      for (Disk disk : tile.disks) {
        if (disk.species != species) continue;
        disk.x = wrapped(disk.x + left, whole.box_length);  // the sum may round up to L
        disk.y = wrapped(disk.y + bottom, whole.box_length);
        whole.disks.push_back(disk);
      }
    }
  }
  return whole;
}

std::size_t tiles_per_side(std::size_t particles, double big_fraction) {
  constexpr double wanted = 1e4;
  constexpr std::size_t least = 5000;
  const auto misfit = [&](std::size_t tile) {
    const double ratio = static_cast<double>(tile) / wanted;
    return ratio > 1 ? ratio : 1 / ratio;
  };
  std::size_t best = 1;
  for (std::size_t per_side = 2; particles / (per_side * per_side) >= least; ++per_side) {
    if (particles % (per_side * per_side) != 0) continue;
    const std::size_t tile = particles / (per_side * per_side);
    const double big_disks = big_fraction * static_cast<double>(tile);
    if (std::fabs(big_disks - std::round(big_disks)) > 1e-12 * static_cast<double>(tile)) continue;
    if (misfit(tile) < misfit(particles / (best * best))) best = per_side;
  }
  return best;
}

}  // namespace sandglass
