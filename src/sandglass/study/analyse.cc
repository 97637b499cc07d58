#include "sandglass/study/analyse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"
#include "sandglass/io/observables.h"
#include "sandglass/observe/correlator.h"
#include "sandglass/observe/structure_sampler.h"
#include "sandglass/observe/thermodynamics.h"
#include "sandglass/study/summarise.h"

namespace sandglass {
namespace {

/// Shows `visit(index)` the frames that the options ask for, in order, as long as it returns true.
template <class Visit>
void for_each_frame(FrameReader& reader, const AnalysisOptions& options, Frame& frame, Visit&& visit) {
  for (std::uint64_t i = 0, used = 0; reader.next(frame); ++i)
    if (i >= options.from && (i - options.from) % options.stride == 0 && !visit(used++)) return;
}

/// When the frames are.
struct Timing {
  double start = 0, step = 0;
  std::uint64_t frames = 0;
};

Timing timing_of(const std::filesystem::path& trajectory, const AnalysisOptions& options, const Progress& progress) {
  FrameReader reader(trajectory, options.frames);
  Frame frame;
  std::vector<double> times;
  for_each_frame(reader, options, frame, [&](std::uint64_t used) {
    times.push_back(frame.time);
    report_progress(progress, "reading", 1 - 1 / static_cast<double>(used + 2));
    return true;
  });
  if (times.empty())
    throw InputError(fmt::format("{} has no frame from number {} on; lower --from", trajectory.string(), options.from));
  Timing timing{times[0], 0, times.size()};
  if (times.size() < 2) return timing;
  timing.step = (times.back() - times[0]) / static_cast<double>(times.size() - 1);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    if (std::fabs(times[i + 1] - times[i] - timing.step) <= 1e-4 * timing.step) continue;
    throw InputError(fmt::format(
        "{}: frames are not evenly spaced in time: {} from frame {} to the next, {} on average. Lags between frames "
        "would not be defined; choose evenly spaced ones with --from and --stride",
        trajectory.string(), times[i + 1] - times[i], options.from + i * options.stride, timing.step));
  }
  return timing;
}

MeasurementPlan plan_of(const Timing& timing, const AnalysisOptions& options) {
  const std::uint64_t steps = timing.frames - 1;
  const std::uint64_t wanted = options.blocks > 0 ? options.blocks : steps >= 20 ? 10 : 2;
  MeasurementPlan plan;
  plan.start = 0;
  plan.intervals = std::clamp<std::uint64_t>(wanted, 1, std::max<std::uint64_t>(1, steps));
  plan.temperature_samples = std::max<std::uint64_t>(1, steps / plan.intervals);
  plan.interval_length = steps > 0 ? static_cast<double>(plan.temperature_samples) * timing.step : 1;
  plan.shortest_lag = plan.interval_length / static_cast<double>(plan.temperature_samples);
  plan.origins = 1;
  plan.lags_per_decade = options.lags_per_decade;
  plan.wavenumbers = options.wavenumbers;
  plan.overlap_length = options.overlap_length;
  plan.selection_time = options.selection_time;
  plan.bin_width = options.bin_width;
  plan.structure_frames = timing.frames;
  return plan;
}

/// Times of frames for the series of temperatures: logarithmic, as a run has them, twenty to a decade.
std::vector<double> series_times(const Timing& timing) {
  std::vector<double> times{0};
  for (double next = 1; next < static_cast<double>(timing.frames); next = std::fmax(next + 1, std::round(next * 1.122)))
    times.push_back(next * timing.step);
  return times;
}

/// Shows an observer of evenly spaced moments all that is due up to half a step after `frame`.
template <class Observer>
void show(Observer& observer, Frame& frame, double step) {
  const double time = frame.time;
  while (observer.next_sample() < time + step / 2) {
    frame.time = observer.next_sample();
    observer.sample(frame);
  }
  frame.time = time;
}

/// The disks where `frame` has them.
State state_at(State disks, const Frame& frame) {
  for (std::size_t id = 0; id < disks.size(); ++id) disks.disks[id].x = frame.x[id], disks.disks[id].y = frame.y[id];
  return disks;
}

bool needs_velocities(const Dataset& dataset) {
  return dataset.path.find("velocity") != std::string::npos || dataset.path.find("temperature") != std::string::npos;
}
bool needs_collisions(const Dataset& dataset) { return dataset.path.ends_with("/collision_rate"); }

}  // namespace

Analysis analyse(const std::filesystem::path& trajectory, const std::filesystem::path& folder,
                 const AnalysisOptions& options, const Progress& progress) {
  const Timing timing = timing_of(trajectory, options, progress);
  const MeasurementPlan plan = plan_of(timing, options);
  FrameReader reader(trajectory, options.frames);
  const State& disks = reader.disks();
  if (disks.box_length < minimum_box_length(disks.mixture))
    throw InputError(
        fmt::format("{}: the box is too small: its side is less than 8 big radii. Are the radii in the "
                    "unit of length of the file?",
                    trajectory.string()));
  const Population population = population_of(disks);
  Correlator correlator(plan, population, make_frame_schedule(plan, plan.temperature_samples));
  IntervalAverages averages(plan, population);
  Timeseries temperatures(population, series_times(timing));
  StructureSampler structure(plan, population);
  Frame frame;
  double first_collisions = 0, last_collisions = 0;
  for_each_frame(reader, options, frame, [&](std::uint64_t used) {
    if (used == 0) first_collisions = frame.collisions_per_disk;
    last_collisions = frame.collisions_per_disk;
    frame.time = static_cast<double>(used) * timing.step;
    structure.sample(frame);
    if (timing.frames > 1) {
      show(correlator, frame, timing.step);
      show(averages, frame, timing.step);
      show(temperatures, frame, timing.step);
    }
    report_progress(progress, "measuring", static_cast<double>(used + 1) / static_cast<double>(timing.frames));
    return used + 1 < timing.frames;
  });

  std::vector<Dataset> datasets = structure.results();
  if (timing.frames > 1)
    for (const auto& more : {correlator.results(), averages.results(), temperatures.results()})
      datasets.insert(datasets.end(), more.begin(), more.end());
  std::erase_if(datasets, [&](const Dataset& dataset) {
    return (!reader.has_velocities() && needs_velocities(dataset)) ||
           (!reader.counts_collisions() && needs_collisions(dataset));
  });
  if (!reader.counts_collisions())
    for (Dataset& dataset : datasets)
      if (auto* values = std::get_if<std::vector<double>>(&dataset.values); dataset.path.ends_with("/collisions"))
        values->assign(values->size(), Summary::unknown);

  Summary summary;
  summary.from_frames = true;
  summary.version = version;
  summary.particles = disks.size();
  summary.packing_fraction = packing_fraction(disks);
  summary.box_length = disks.box_length;
  if (timing.frames > 1) {
    summary.time = plan.end() - plan.start;
    summarise_frames(correlator, structure, options.exponent_range, summary);
    if (reader.counts_collisions()) {
      summary.collisions_per_particle = last_collisions - first_collisions;
      summary.collision_rate = correlator.collision_rate();
    } else {
      for (auto* diffusion : {&summary.diffusion.small, &summary.diffusion.big, &summary.diffusion.all})
        *diffusion = {};
    }
    if (reader.has_velocities()) {
      const Estimate all = averages.temperature(Group::all), small_disks = averages.temperature(Group::small),
                     big_disks = averages.temperature(Group::big);
      summary.temperature = {all.value, small_disks.value, big_disks.value};
      summary.errors.insert(summary.errors.begin(), {{"temperature_all", all.error},
                                                     {"temperature_small", small_disks.error},
                                                     {"temperature_big", big_disks.error}});
    }
  }
  summary.decisions = reader.decisions();
  summary.decisions.push_back(fmt::format(
      "Measured on {} stored frames of {}, {:.6g} time units apart, in {} blocks of {} steps. What frames do not hold "
      "(seed, pressure, kicks, energies) is left out.",
      timing.frames, trajectory.string(), timing.step, plan.intervals, plan.temperature_samples));
  if (reader.largest_step() > 0.25)
    summary.warnings.push_back(
        fmt::format("Disks were followed to their nearest image from frame to frame, and one went {:.2g} box lengths "
                    "at once: frames "
                    "may be too far apart for that, and displacements too short. Store image counts, or more frames.",
                    reader.largest_step()));
  if (reader.slow_frames() > 0)
    summary.warnings.push_back(fmt::format(
        "In {} of the frames read no disk is faster than 10^-5 radii of the smallest per unit of time, as in a fluid "
        "that has cooled: what is said of velocities there has few digits, or none.",
        reader.slow_frames()));
  write_observables(folder / "observables.h5", datasets);
  write_summary(folder / "summary.json", summary);
  return {std::move(summary), state_at(disks, frame)};
}

}  // namespace sandglass
