#include "sandglass/prepare/file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/expand.h"
#include "sandglass/prepare/periodic.h"

namespace sandglass {
namespace {

void check_composition(const State& loaded, std::size_t small_count, std::size_t big_count, const Mixture& mixture) {
  const auto found_small = static_cast<std::size_t>(
      std::count_if(loaded.disks.begin(), loaded.disks.end(), [](const Disk& disk) { return disk.species == small; }));
  const std::size_t found_big = loaded.size() - found_small;
  if (found_small != small_count || found_big != big_count) {
    throw InputError(
        fmt::format("the start state holds {} small and {} big disks, but {} and {} are configured: set "
                    "system.particles and system.big_fraction to those of the file",
                    found_small, found_big, small_count, big_count));
  }
  for (int species = 0; species < species_count; ++species) {
    const double found = loaded.mixture.radius[species], wanted = mixture.radius[species];
    if (std::fabs(found - wanted) <= 1e-12 * wanted) continue;
    throw InputError(
        fmt::format("the start state has {} disks of radius {}, but {} is configured: set system.size_ratio to that "
                    "of the file",
                    species == small ? "small" : "big", found, wanted));
  }
}

}  // namespace

State adapt_state(const State& loaded, std::size_t small_count, std::size_t big_count, const Mixture& mixture,
                  double packing_fraction, std::uint64_t seed) {
  checked_box_length(mixture, small_count, big_count, packing_fraction);
  check_composition(loaded, small_count, big_count, mixture);
  State state;
  state.box_length = loaded.box_length;
  state.mixture = mixture;
  state.seed = seed;
  state.disks.reserve(loaded.size());
  for (const Species species : {small, big}) {
    for (const Disk& disk : loaded.disks) {
      if (disk.species != species) continue;
      const double flight = loaded.now - disk.time;
      Disk& fresh = state.disks.emplace_back();
      fresh.x = wrapped(disk.x + disk.vx * flight, state.box_length);
      fresh.y = wrapped(disk.y + disk.vy * flight, state.box_length);
      fresh.species = species;
    }
  }
  check_no_overlap(state);
  expand(state, packing_fraction);
  const double depth = deepest_overlap(state).depth;
  if (depth <= touching_tolerance) return state;
  // Rounded down, so that asking for the printed value works.
  const double greatest = std::floor(packing_fraction * (1 - depth) * (1 - depth) * 1e6) / 1e6;
  throw InputError(
      fmt::format("the start state cannot be compressed to packing fraction {:.6g}: disks would overlap above {:.6f}; "
                  "ask for at most that, or prepare with method quench",
                  packing_fraction, greatest));
}

}  // namespace sandglass
