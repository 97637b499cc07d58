#include "sandglass/prepare/insert.h"

#include <fmt/core.h>

#include <algorithm>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/grid.h"
#include "sandglass/prepare/periodic.h"

namespace sandglass {
namespace {

constexpr std::uint64_t most_trials = 10'000'000;

/// Puts disk `id` at the first trial position with no overlap. Each draw of random words serves two trials.
void insert_disk(State& state, Grid& grid, std::uint32_t id) {
  const double box = state.box_length;
  Disk& disk = state.disks[id];
  std::array<std::uint64_t, 4> words{};
  for (std::uint64_t trial = 0; trial < most_trials; ++trial) {
    if (trial % 2 == 0) words = random_words(state.seed, Stream::positions, id, trial / 2);
    const double x = box * uniform(words[2 * (trial % 2)]), y = box * uniform(words[2 * (trial % 2) + 1]);
    if (x >= box || y >= box) continue;  // the product may round up to L
    const bool free = grid.visit_near(x, y, [&](std::uint32_t other_id) {
      const Disk& other = state.disks[other_id];
      const double dx = nearest_image(x - other.x, box), dy = nearest_image(y - other.y, box);
      const double contact = state.mixture.radius[disk.species] + state.mixture.radius[other.species];
      return dx * dx + dy * dy > contact * contact;
    });
    if (!free) continue;
    disk.x = x, disk.y = y;
    grid.add(id, x, y);
    return;
  }
  throw RunError(fmt::format("no hole found for disk {} in {} trials: prepare with method quench", id, most_trials));
}

}  // namespace

State insert_disks(std::size_t small_count, std::size_t big_count, const Mixture& mixture, double packing_fraction,
                   std::uint64_t seed, const Progress& progress) {
  State state;
  state.box_length = checked_box_length(mixture, small_count, big_count, packing_fraction);
  if (packing_fraction > insert_limit) {
    throw InputError(
        fmt::format("random insertion cannot reach packing fraction {:.6g}: it jams near 0.55 and is refused above "
                    "{:.6g}; prepare with method quench",
                    packing_fraction, insert_limit));
  }
  state.mixture = mixture;
  state.seed = seed;
  state.disks.resize(small_count + big_count);
  for (std::size_t id = small_count; id < state.size(); ++id) state.disks[id].species = big;

  Grid grid(state.box_length, 2 * std::max(mixture.radius[small], mixture.radius[big]), state.size());
  // Ids count down: big disks first, while the holes are still wide.
  for (std::size_t left = state.size(); left > 0; --left) {
    insert_disk(state, grid, static_cast<std::uint32_t>(left - 1));
    if (left % 65536 == 0) {
      report_progress(progress, "inserting disks", 1 - static_cast<double>(left) / static_cast<double>(state.size()));
    }
  }
  report_progress(progress, "inserting disks", 1);
  return state;
}

}  // namespace sandglass
