#include "sandglass/study/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>

#include "sandglass/core/errors.h"
#include "sandglass/observe/contact_rate.h"
#include "sandglass/prepare/periodic.h"
#include "sandglass/prepare/prepare.h"
#include "sandglass/study/calibrate.h"
#include "sandglass/study/start.h"
#include "sandglass/theory/equation_of_state.h"

namespace sandglass {
namespace {

/// Wall clock and processor time of the process, in seconds.
struct Stopwatch {
  double wall, processor;

  static Stopwatch now() {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return {std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
            static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec)};
  }
};

/// A line of /proc/self/status in bytes: VmRSS, resident memory, or VmHWM, the most there ever was; 0 elsewhere.
double resident_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != name + ":") continue;
    double kilobytes = 0;
    status >> kilobytes;
    return 1024 * kilobytes;
  }
  return 0;
}

State make_tile(const BenchmarkPlan& plan, std::size_t tiles, const Progress& progress) {
  Config config = plan.config;
  config.system.particles /= tiles;
  State tile = make_start(config, progress);
  if (tile.drive.kind == DriveKind::none) return tile;
  CalibrationGoal goal{.temperature = config.drive.temperature,
                       .frequency = config.drive.frequency,
                       .beat = beat_of(config),
                       .temperature_error = 0.01};
  if (config.system.packing_fraction > 0.78) goal.settle = plan.age;  // as a run does: there the rate ages for long
  const Calibration calibration = calibrate(tile, goal, progress);
  tile.drive.frequency = calibration.frequency;
  tile.drive.amplitude = calibration.amplitude;
  return tile;
}

double collisions_per_disk(const Simulation& simulation) {
  return 2.0 * static_cast<double>(simulation.tally().collisions()) / static_cast<double>(simulation.size());
}

/// Runs for `age` collisions per disk, to a whole beat. Returns the collision rate per disk over the second half.
double age_disks(Simulation& simulation, double age, double beat, const Progress& progress) {
  std::uint64_t beats = 0, half_beats = 0;
  double half = 0;
  for (double done = 0; done < age;) {
    if (done < age / 2) half_beats = beats, half = done;
    simulation.run_until(static_cast<double>(++beats) * beat);
    done = collisions_per_disk(simulation);
    report_progress(progress, "ageing", std::min(done / age, 1.0));
  }
  return (collisions_per_disk(simulation) - half) / (static_cast<double>(beats - half_beats) * beat);
}

/// Frames in each repeat for the self-check: 4 * 10^6 disks in all, which count the pairs near contact to 0.25 %
/// where elastic; none where the equation of state is checked.
std::uint64_t frames_per_repeat(const BenchmarkPlan& plan) {
  constexpr double looked_at = 4e6, most = 1000;
  if (has_equation_of_state(plan.config.system.packing_fraction, plan.config.collision.restitution)) return 0;
  const double all = static_cast<double>(plan.config.system.particles) * static_cast<double>(plan.repeats);
  return static_cast<std::uint64_t>(std::fmin(std::ceil(looked_at / all), most));
}

/// What the engine did while the clock ran, in seconds and collisions.
struct Work {
  double wall = 0, processor = 0, collisions = 0;

  void run_until(Simulation& simulation, double end) {
    const std::uint64_t before = simulation.tally().collisions();
    const Stopwatch began = Stopwatch::now();
    simulation.run_until(end);
    const Stopwatch ended = Stopwatch::now();
    wall += ended.wall - began.wall;
    processor += ended.processor - began.processor;
    collisions += static_cast<double>(simulation.tally().collisions() - before);
  }
};

/// The repeats. In the middle of each, so that a drift of the rate cancels, the clock stands still while frames a mean
/// free time apart are looked at.
void measure(Simulation& simulation, const BenchmarkPlan& plan, double collision_rate, ContactRate& contacts,
             Evidence& evidence, Benchmark& result, const Progress& progress) {
  const auto disks = static_cast<double>(simulation.size());
  const auto repeats = static_cast<double>(plan.repeats);
  const double stretch = plan.collisions.value_or(default_collisions(simulation.size())) / (repeats * collision_rate);
  const std::uint64_t frames = frames_per_repeat(plan);
  evidence.interval_length = stretch + static_cast<double>(frames) / collision_rate;
  evidence.boundaries.push_back(simulation.tally());
  const double start = simulation.time();
  Frame frame;
  for (std::uint64_t repeat = 0; repeat < plan.repeats; ++repeat) {
    report_progress(progress, "measuring", static_cast<double>(repeat) / repeats);
    const double middle = start + static_cast<double>(repeat) * evidence.interval_length + stretch / 2;
    Work work;
    work.run_until(simulation, middle);
    if (repeat == 0) result.bytes_per_disk = resident_bytes("VmRSS") / disks;
    for (std::uint64_t i = 1; i <= frames; ++i) {
      simulation.run_until(middle + static_cast<double>(i) / collision_rate);
      simulation.make_frame(frame);
      contacts.add(frame);
    }
    work.run_until(simulation, start + static_cast<double>(repeat + 1) * evidence.interval_length);
    evidence.boundaries.push_back(simulation.tally());
    result.rates.push_back(work.collisions / work.wall);
    result.wall_seconds += work.wall;
    result.cpu_seconds += work.processor;
    result.measured += 2 * work.collisions / disks;
  }
  report_progress(progress, "measuring", 1);
}

double deepest_overlap_now(State state) {
  for (Disk& disk : state.disks) {
    const double flight = state.now - disk.time;
    disk.x = wrapped(disk.x + disk.vx * flight, state.box_length);
    disk.y = wrapped(disk.y + disk.vy * flight, state.box_length);
  }
  return deepest_overlap(state).depth;
}

Simulation::Bookkeeping difference(const Simulation::Bookkeeping& begin, const Simulation::Bookkeeping& end) {
  return {end.predictions - begin.predictions,
          end.orphans - begin.orphans,
          end.list_rebuilds - begin.list_rebuilds,
          end.wide_partner_searches - begin.wide_partner_searches,
          end.windows - begin.windows,
          end.frozen - begin.frozen,
          end.left_over - begin.left_over,
          end.windows_undone - begin.windows_undone};
}

/// What was counted between two tallies.
Tally counts_between(const Tally& begin, const Tally& end) {
  Tally counts;
  for (std::size_t pair = 0; pair < 3; ++pair) counts.contacts[pair] = end.contacts[pair] - begin.contacts[pair];
  for (const Species species : {small, big}) counts.kicked[species] = end.kicked[species] - begin.kicked[species];
  counts.elastic_contacts = end.elastic_contacts - begin.elastic_contacts;
  counts.kicks = end.kicks - begin.kicks;
  counts.kicks_without_partner = end.kicks_without_partner - begin.kicks_without_partner;
  counts.transits = end.transits - begin.transits;
  return counts;
}

void check_plan(const BenchmarkPlan& plan) {
  check_config(plan.config);
  if (plan.config.collision.restitution < 1 && plan.config.drive.kind == DriveKind::none)
    throw InputError(
        fmt::format("restitution {} without drive is no benchmark: the disks cool and cluster, and the rate depends on "
                    "how long they have done so; add --drive pair, or take restitution 1",
                    plan.config.collision.restitution));
  if (plan.config.collision.restitution < least_checked_restitution)
    throw InputError(
        fmt::format("restitution {} has no self-check: below {} pairs meet again within gaps too small to count, so "
                    "that frames do not tell the collision rate; take a restitution of {} or more",
                    plan.config.collision.restitution, least_checked_restitution, least_checked_restitution));
  if (!(plan.age >= 2))
    throw InputError(fmt::format(
        "an age of {} collisions per disk is too short to find the collision rate from: take at least 2", plan.age));
  if (plan.repeats < 1 || (plan.collisions && !(*plan.collisions > 0)))
    throw InputError("a benchmark needs at least one repeat and a positive number of collisions per disk");
}

}  // namespace

double default_collisions(std::size_t particles) { return std::fmax(4e7 / static_cast<double>(particles), 5.0); }

Benchmark run_benchmark(const BenchmarkPlan& plan, const Progress& progress) {
  check_plan(plan);
  const Config& config = plan.config;
  Benchmark result;
  result.tiles_per_side = tiles_per_side(config.system.particles, config.system.big_fraction);
  State state = repeat_periodically(make_tile(plan, result.tiles_per_side * result.tiles_per_side, progress),
                                    result.tiles_per_side);
  draw_velocities(state, config.drive.temperature);
  start_kick_clocks(state);

  Evidence evidence;
  evidence.mixture = state.mixture;
  const Counts counts = counts_of(config);
  evidence.disks = {counts.small, counts.big};
  evidence.packing_fraction = config.system.packing_fraction;
  evidence.restitution = config.collision.restitution;
  const double factor = compressibility_factor(state.mixture, config.system.big_fraction, evidence.packing_fraction);
  ContactRate contacts(population_of(state), contact_range(factor, evidence.restitution));

  evidence.start = state.tally;
  evidence.start_energy = kinetic_energy(state);
  Simulation simulation(std::move(state), {.threads = threads_for(config.system.particles, config.run.threads)});
  result.threads = simulation.threads();
  const double rate = age_disks(simulation, plan.age, beat_of(config), progress);
  result.aged = collisions_per_disk(simulation);
  const Simulation::Bookkeeping before = simulation.bookkeeping();
  measure(simulation, plan, rate, contacts, evidence, result, progress);
  result.events = counts_between(evidence.boundaries.front(), evidence.boundaries.back());
  result.bookkeeping = difference(before, simulation.bookkeeping());

  State end = std::move(simulation).state();
  result.peak_bytes_per_disk = resident_bytes("VmHWM") / static_cast<double>(end.size());
  result.state_hash = state_hash(end);
  result.kick_frequency = end.drive.frequency;
  result.kick_amplitude = end.drive.amplitude;
  result.temperature = temperatures(end).all;
  evidence.end_energy = kinetic_energy(end);
  evidence.deepest_overlap = deepest_overlap_now(std::move(end));
  for (std::size_t pair = 0; pair < 3; ++pair) evidence.foretold[pair] = contacts.collisions_per_time(pair);
  result.check = check_figures(evidence);
  return result;
}

}  // namespace sandglass
