#include "sandglass/study/cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <numeric>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/observe/correlator.h"
#include "sandglass/observe/structure_sampler.h"
#include "sandglass/prepare/insert.h"
#include "sandglass/prepare/repeat.h"
#include "sandglass/study/start.h"

namespace sandglass {
namespace {

template <std::size_t n>
using Table = std::array<std::pair<double, double>, n>;

// Seconds against packing fraction, `sandglass bench` at 10^4 disks (restitution matters little); and the factor for
// another number of disks, against its logarithm: larger tables leave the caches.
constexpr Table<5> driven_collision{{{0.1, 1.2e-6}, {0.3, 0.8e-6}, {0.5, 0.57e-6}, {0.7, 0.48e-6}, {0.8, 0.43e-6}}};
constexpr Table<5> undriven_collision{
    {{0.1, 0.81e-6}, {0.3, 0.45e-6}, {0.5, 0.255e-6}, {0.7, 0.186e-6}, {0.8, 0.166e-6}}};
constexpr Table<4> size_factor{{{3, 0.93}, {4, 1}, {5, 1.5}, {6.6, 2.9}}};
// Seconds per disk, and of what a run does once, mostly its report.
constexpr double quench = 5e-5, insertion = 1e-6, comparison = 2.5e-8, structure_frame = 1e-5, once = 0.2;

constexpr double probe_seconds = 0.2;
constexpr std::uint64_t probe_particles = 4000, large_particles = 20000;
constexpr std::size_t large_probe_per_side = 7;  // copies of the small probe
constexpr double large_probe = probe_particles * large_probe_per_side * large_probe_per_side;
constexpr std::size_t most_probes = 5;

double mixed(double a, double b, double part_of_b) { return a + (b - a) * part_of_b; }
Costs mixed(const Costs& a, const Costs& b, double part_of_b) {
  return {mixed(a.preparing, b.preparing, part_of_b), mixed(a.collision, b.collision, part_of_b),
          mixed(a.comparison, b.comparison, part_of_b), mixed(a.structure, b.structure, part_of_b)};
}

/// Linear between the points, constant beyond them.
template <class Points>
auto interpolate(const Points& points, double x) {
  if (x <= points.front().first) return points.front().second;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto& [x0, y0] = points[i - 1];
    const auto& [x1, y1] = points[i];
    if (x <= x1) return mixed(y0, y1, (x - x0) / (x1 - x0));
  }
  return points.back().second;
}

Costs reference_costs(const Config& config) {
  const double eta = config.system.packing_fraction;
  const bool driven = config.drive.kind != DriveKind::none;
  return {.preparing = config.prepare.method == PrepareMethod::quench ? quench : insertion,
          .collision = driven ? interpolate(driven_collision, eta) : interpolate(undriven_collision, eta),
          .comparison = comparison,
          .structure = structure_frame};
}

double log_size(const Config& config) { return std::log10(static_cast<double>(config.system.particles)); }

/// Collisions per disk in the windows of study/calibrate: two rough ones, then 3 to 12 finer ones, 6 on average.
double calibration_length(const Config& config) {
  if (config.drive.kind == DriveKind::none) return 0;
  constexpr double rough = 2, fine = 6, error = 0.002;
  const double disks = static_cast<double>(config.system.particles);
  const double relaxation = 4 / (3 * (1 - config.collision.restitution * config.collision.restitution));
  const double wanted = std::fmax(error, 0.05 / std::sqrt(disks));
  const double window = std::clamp(relaxation / (disks * wanted * wanted), 25.0, 5e3);
  const double settle = config.system.packing_fraction > 0.78 ? config.run.equilibrate : 0;
  return settle + (rough + fine) * 5 * relaxation + (rough / 2 + fine) * window;
}

/// How the run will be measured, in mean free times.
MeasurementPlan plan_of(const Config& config) {
  const double interval = std::fmax(config.run.collisions / static_cast<double>(config.run.intervals), 1.0);
  MeasurementPlan plan = plan_measurement(0, interval, config.run.intervals, 1, config.observe.lags_per_decade,
                                          config.observe.wavenumbers);
  plan.structure_frames = config.observe.structure_frames ? static_cast<std::uint64_t>(*config.observe.structure_frames)
                                                          : affordable_structure_frames(plan, 1);
  return plan;
}

/// Collisions of runs of so many collisions per disk, were they all as fast as those of small systems.
double collisions(const Config& config, double length) {
  return length * static_cast<double>(config.system.particles) / 2 * interpolate(size_factor, log_size(config));
}

/// How often the run does each kind of work.
Costs work_of(const Config& config) {
  const auto disks = static_cast<double>(config.system.particles);
  const Config calibrated = calibration_config(config);
  const bool apart = calibrated.system.particles < config.system.particles;
  const MeasurementPlan plan = plan_of(config);
  return {.preparing = disks + (apart ? static_cast<double>(calibrated.system.particles) : 0),
          .collision = collisions(calibrated, calibration_length(calibrated)) +
                       collisions(config, config.run.equilibrate + config.run.collisions),
          .comparison = disks * static_cast<double>(plan.intervals * make_schedule(plan).evaluations()),
          .structure = disks * static_cast<double>(plan.structure_frames)};
}

Costs operator*(const Costs& a, const Costs& b) {
  return {a.preparing * b.preparing, a.collision * b.collision, a.comparison * b.comparison, a.structure * b.structure};
}
Costs operator/(const Costs& a, const Costs& b) {
  return {a.preparing / b.preparing, a.collision / b.collision, a.comparison / b.comparison, a.structure / b.structure};
}
double sum(const Costs& c) { return c.preparing + c.collision + c.comparison + c.structure; }

double processor_seconds() {
  timespec used{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// The same state point, small enough to be prepared in a moment.
Config small_version(Config config) {
  if (config.prepare.method == PrepareMethod::file) {  // of another size; the probe makes its own start
    config.prepare = {};
    if (config.system.packing_fraction <= insert_limit) config.prepare.method = PrepareMethod::insert;
  }
  return smaller_config(config, probe_particles);
}

/// Processor time of one unit of what `work` does, which returns how many units it has done; it is called until the
/// time is over or there is no more to do.
template <class Work>
double seconds_per_unit(Work&& work) {
  const double began = processor_seconds();
  double used = 0, units = 0;
  while (used < probe_seconds) {
    const double more = work();
    used = processor_seconds() - began;
    if (!(more > 0)) break;
    units += more;
  }
  return units > 0 ? used / units : 0;
}

/// A simulation on the way to where it will be in the run: its kicks as frequent as its collisions.
class Probe {
 public:
  Probe(const Config& config, State start) : config_(config), beat_(beat_of(config)), simulation_(std::move(start)) {
    advance(10);
    if (config.drive.kind == DriveKind::none || config.drive.frequency) return;
    State state = simulation_.state();
    const double rate = 2 * advance(10) / (10 * beat_ * static_cast<double>(simulation_.size()));
    change_drive(state, rate, state.drive.amplitude * std::sqrt(state.drive.frequency / rate));
    beats_ -= 10;
    simulation_ = Simulation(std::move(state));
    advance(5);
  }

  [[nodiscard]] double collision() {
    return seconds_per_unit([&] { return advance(1); }) / interpolate(size_factor, log10(simulation_.size()));
  }
  [[nodiscard]] double comparison() const;
  [[nodiscard]] double structure() const;

 private:
  static double log10(std::size_t disks) { return std::log10(static_cast<double>(disks)); }
  /// The collisions of so many beats.
  double advance(std::uint64_t beats) {
    const std::uint64_t before = simulation_.tally().collisions();
    simulation_.run_until(static_cast<double>(beats_ += beats) * beat_);
    return static_cast<double>(simulation_.tally().collisions() - before);
  }
  [[nodiscard]] Frame frame() const {
    Frame frame;
    simulation_.make_frame(frame);
    return frame;
  }

  const Config& config_;
  double beat_;
  Simulation simulation_;
  std::uint64_t beats_ = 0;
};

// Where the disks are matters little for what it costs to look at them: one frame is shown again and again.

double Probe::comparison() const {
  const MeasurementPlan plan = plan_of(config_);
  Correlator correlator(plan, population_of(simulation_.state()));
  Frame shown = frame();
  const Schedule schedule = make_schedule(plan);
  const double evaluations = static_cast<double>(schedule.evaluations()) / static_cast<double>(schedule.frames());
  return seconds_per_unit([&] {
    const double due = correlator.next_sample();
    if (!std::isfinite(due)) return 0.0;
    simulation_.make_frame(shown);
    shown.time = due;
    correlator.sample(shown);
    return evaluations * static_cast<double>(shown.size());
  });
}

double Probe::structure() const {
  StructureSampler sampler(plan_of(config_), population_of(simulation_.state()));
  const Frame shown = frame();
  return seconds_per_unit([&] {
    if (!std::isfinite(sampler.next_sample())) return 0.0;
    sampler.sample(shown);
    return static_cast<double>(shown.size());
  });
}

/// This machine's times at a state point.
Costs probe(const Config& campaign_point) {
  const Config config = small_version(campaign_point);
  const double began = processor_seconds();
  State start = make_start(config);
  const double preparing = (processor_seconds() - began) / static_cast<double>(start.size());
  Probe probe(config, std::move(start));
  return {preparing, probe.collision(), probe.comparison(), probe.structure()};
}

/// This machine's time per collision in a large system, as far as the factor of small ones does not tell.
double probe_large(const Config& campaign_point, double small_factor) {
  const Config config = small_version(campaign_point);
  State start = repeat_periodically(make_start(config), large_probe_per_side);
  draw_velocities(start, config.drive.temperature);
  start_kick_clocks(start);
  return Probe(config, std::move(start)).collision() / (reference_costs(config).collision * small_factor);
}

}  // namespace

double reference_seconds(const Config& config) { return sum(work_of(config) * reference_costs(config)) + once; }

double expected_bytes(const Config& config) {
  const auto disks = static_cast<double>(config.system.particles),
             intervals = static_cast<double>(config.run.intervals);
  // The lags of an interval reach from a fiftieth of a mean free time to its whole length; every decade keeps the
  // positions and velocities at one origin, every lag ten sums per interval.
  const double decades = std::fmax(std::ceil(std::log10(50 * config.run.collisions / intervals)), 1.0);
  const double checkpoint = disks * (73 + 32 * decades) + intervals * decades * config.observe.lags_per_decade * 160;
  const double trajectory = disks * (17 + 40 * static_cast<double>(config.output.trajectory_frames));
  constexpr double report_and_observables = 6e5;
  return 2 * checkpoint + trajectory + report_and_observables;
}

double Pace::seconds(const Config& config) const {
  const Costs factor = interpolate(factors, config.system.packing_fraction);
  Costs work = work_of(config);
  work.collision *= interpolate(Table<2>{{{4, 1}, {std::log10(large_probe), large}}}, log_size(config));
  return sum(work * reference_costs(config) * factor) + once * factor.comparison;
}

double pace_uncertainty(std::span<const Config> configs) {
  constexpr double small = 0.3, large = 0.5;
  double all = 0, uncertain = 0;
  for (const Config& config : configs) {
    const double seconds = reference_seconds(config);
    all += seconds;
    uncertain += seconds * (config.system.particles > large_particles ? large : small);
  }
  return all > 0 ? uncertain / all : small;
}

Pace probe_pace(std::span<const Config> configs, const Progress& progress) {
  std::vector<const Config*> by_density;
  for (const Config& config : configs) by_density.push_back(&config);
  std::stable_sort(by_density.begin(), by_density.end(), [](const Config* a, const Config* b) {
    return a->system.packing_fraction < b->system.packing_fraction;
  });
  Pace pace;
  if (by_density.empty()) return pace;
  pace.factors.clear();
  for (std::size_t i = 0; i < most_probes; ++i) {
    const Config& config = *by_density[i * (by_density.size() - 1) / (most_probes - 1)];
    const double eta = config.system.packing_fraction;
    if (!pace.factors.empty() && pace.factors.back().first == eta) continue;
    report_progress(progress, "probing the speed of this machine", static_cast<double>(i) / most_probes);
    pace.factors.emplace_back(eta, probe(config) / reference_costs(small_version(config)));
  }
  const auto is_large = [](const Config* config) { return config->system.particles > large_particles; };
  std::erase_if(by_density, std::not_fn(is_large));
  if (!by_density.empty()) {
    const Config& config = *by_density[by_density.size() / 2];
    pace.large = probe_large(config, interpolate(pace.factors, config.system.packing_fraction).collision);
  }
  report_progress(progress, "probing the speed of this machine", 1);
  return pace;
}

}  // namespace sandglass
