// What it costs to make the list of one disk anew.
#include "sandglass/dynamics/neighbours.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Every disk in turn moves from where it is in one state to where it is in the other; next time it moves back, so that
/// the density stays as it is.
void renew(benchmark::State& state, const State& here, const State& there, double skin) {
  const auto size = static_cast<std::uint32_t>(here.disks.size());
  const double cell_size = here.box_length * std::sqrt(2.0 / size);  // as in the engine
  Array<ColdRecord> cold(size);
  NeighbourTable table(cold, Box(here.box_length, here.mixture), here.mixture, skin, cell_size);
  Neighbours neighbours(table);
  Array<Record> records(size);
  Array<FixedPoint> centres[2] = {Array<FixedPoint>(size), Array<FixedPoint>(size)};
  for (std::uint32_t slot = 0; slot < size; ++slot) {
    const Disk &from = here.disks[slot], &to = there.disks[slot];
    centres[0][slot] = neighbours.grid().point(from.x, from.y);
    centres[1][slot] = neighbours.grid().point(to.x, to.y);
    records[slot].species = from.species;
    records[slot].radius = here.mixture.radius[from.species];
    neighbours.enter(slot, centres[0][slot], &records[0]);
  }
  const std::uint32_t step = 3819;  // has no factor in common with 10^4: from place to place, as lists expire
  std::uint32_t slot = 0;
  unsigned at = 0;
  for (auto _ : state) {
    neighbours.renew(slot, centres[at][slot], centres[1 - at][slot], &records[0]);
    benchmark::DoNotOptimize(neighbours.tell_others(slot, &records[0], false));
    slot = (slot + step) % size;
    if (slot == 0) at = 1 - at;
  }
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
