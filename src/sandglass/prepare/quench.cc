#include "sandglass/prepare/quench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/expand.h"
#include "sandglass/prepare/periodic.h"
#include "sandglass/prepare/soft_disks.h"

namespace sandglass {
namespace {

constexpr double densest = 0.9;         // the triangular packing of equal disks has 0.907
constexpr double start_fraction = 0.6;  // of the jammed area fraction, at which the disks are thrown in
constexpr int compression_steps = 800;  // 200 time units, about a hundred contact durations pi sqrt(mu / k)
constexpr double greatest_rest_overlap = 0.005;
constexpr double narrowest_box = 7;  // in R_b: what SoftDisks needs; the expansion widens the box to 8 R_b or more
constexpr int steps_between_looks = 40;

/// Steps in which the largest overlap must fall by a tenth, or the packing counts as jammed. Without jamming it falls
/// about as 1 / time, and in wide boxes only as fast as sound (speed about 1) evens out the density across the box.
std::int64_t patience(double box_length) {
  return static_cast<std::int64_t>((250 + box_length) / SoftDisks::time_step);
}

/// Small systems may jam below the wanted density, the smaller the likelier (at N = 24 and 0.84 nine of ten do).
std::uint64_t most_attempts(std::size_t count) { return std::clamp<std::uint64_t>(40000 / count, 3, 2000); }

SoftDisks random_disks(const State& state, std::uint64_t attempt) {
  std::vector<SoftDisk> disks(state.size());
  for (std::size_t id = 0; id < disks.size(); ++id) {
    const auto words = random_words(state.seed, Stream::positions, id, attempt);
    const Species species = state.disks[id].species;
    disks[id].x = state.box_length * uniform(words[0]);
    disks[id].y = state.box_length * uniform(words[1]);
    disks[id].radius = state.mixture.radius[species];
    disks[id].inverse_mass = 1 / state.mixture.mass[species];
  }
  return {state.box_length, std::move(disks)};
}

/// Compression is done as swelling in a box that has its final size: the same, up to the unit of length.
void compress(SoftDisks& disks, const Progress& progress) {
  const double start = std::sqrt(start_fraction);
  for (int step = 0; step < compression_steps; ++step) {
    const double done = static_cast<double>(step) / compression_steps;
    disks.step(start + (1 - start) * done);
    if (step % 8 == 0) report_progress(progress, "compressing soft disks", done);
  }
}

/// Whether the overlaps fall to `rest_overlap` before the packing counts as jammed.
bool bring_to_rest(SoftDisks& disks, double rest_overlap, std::int64_t most_idle_steps, const Progress& progress) {
  double least_overlap = 1;
  for (std::int64_t step = 0, last_gain = 0; step - last_gain < most_idle_steps; ++step) {
    disks.step(1);
    if (step % steps_between_looks != 0) continue;
    const double overlap = disks.deepest_overlap();
    if (overlap <= rest_overlap) return true;
    if (overlap < 0.9 * least_overlap) least_overlap = overlap, last_gain = step;
    report_progress(progress, "relaxing soft disks", rest_overlap / least_overlap);
  }
  return false;
}

void take_positions(State& state, const SoftDisks& disks) {
  for (std::size_t slot = 0; slot < state.size(); ++slot) {
    Disk& disk = state.disks[disks.ids()[slot]];
    disk.x = wrapped(disks.disks()[slot].x, state.box_length);
    disk.y = wrapped(disks.disks()[slot].y, state.box_length);
  }
}

}  // namespace

State quench_disks(std::size_t small_count, std::size_t big_count, const Mixture& mixture, double packing_fraction,
                   std::uint64_t seed, double jammed_fraction, const Progress& progress) {
  const double wide = checked_box_length(mixture, small_count, big_count, packing_fraction);
  if (!(jammed_fraction > packing_fraction && jammed_fraction <= densest)) {
    throw InputError(
        fmt::format("a quench compresses to prepare.jammed_fraction = {:.6g} and expands to the packing fraction "
                    "{:.6g}: the first must be greater than the second and at most {}",
                    jammed_fraction, packing_fraction, densest));
  }
  State state;
  state.mixture = mixture;
  state.seed = seed;
  state.disks.resize(small_count + big_count);
  for (std::size_t id = small_count; id < state.size(); ++id) state.disks[id].species = big;
  state.box_length = std::max(box_length_for(mixture, small_count, big_count, jammed_fraction),
                              narrowest_box * minimum_box_length(mixture) / 8);

  const double rest_overlap = std::min(greatest_rest_overlap, 0.5 * (1 - state.box_length / wide));
  const std::uint64_t attempts = most_attempts(state.size());
  for (std::uint64_t attempt = 0; attempt < attempts; ++attempt) {
    SoftDisks disks = random_disks(state, attempt);
    compress(disks, progress);
    if (!bring_to_rest(disks, rest_overlap, patience(state.box_length), progress)) continue;
    take_positions(state, disks);
    expand(state, packing_fraction);
    check_no_overlap(state);
    report_progress(progress, "relaxing soft disks", 1);
    return state;
  }
  throw RunError(
      fmt::format("{} quenches of {} soft disks at area fraction {:.6g} all jammed with overlaps above {:.2g} of the "
                  "contact distance: take a lower packing fraction or prepare.jammed_fraction, or more particles",
                  attempts, state.size(), jammed_fraction, rest_overlap));
}

}  // namespace sandglass
