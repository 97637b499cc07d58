#include "sandglass/prepare/expand.h"

#include <cmath>

namespace sandglass {

void expand(State& state, double packing_fraction) {
  std::size_t small_count = 0;
  for (const Disk& disk : state.disks) small_count += disk.species == small;
  const double old_length = state.box_length;
  state.box_length = box_length_for(state.mixture, small_count, state.size() - small_count, packing_fraction);
  const double factor = state.box_length / old_length;
  // Rounding may carry the last centre below L onto L itself, which is 0.
  const auto scaled = [&](double x) { return x * factor < state.box_length ? x * factor : 0.0; };
  for (Disk& disk : state.disks) disk.x = scaled(disk.x), disk.y = scaled(disk.y);
}

}  // namespace sandglass
