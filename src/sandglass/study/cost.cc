#include "sandglass/study/cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numeric>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/prepare/insert.h"
#include "sandglass/study/measurement.h"
#include "sandglass/study/start.h"

namespace sandglass {
namespace {

template <std::size_t n>
using Table = std::array<std::pair<double, double>, n>;

// Nanoseconds per collision against packing fraction, `sandglass bench` at 10^4 disks (restitution matters little); and
// the factor for another number of disks, against its logarithm: larger tables leave the caches.
constexpr Table<5> driven_nanoseconds{{{0.1, 1200}, {0.3, 800}, {0.5, 570}, {0.7, 480}, {0.8, 430}}};
constexpr Table<5> undriven_nanoseconds{{{0.1, 810}, {0.3, 450}, {0.5, 255}, {0.7, 186}, {0.8, 166}}};
constexpr Table<4> size_factor{{{3, 0.93}, {4, 1}, {5, 1.5}, {6.6, 2.9}}};

constexpr double quench_seconds_per_disk = 8e-5, insert_seconds_per_disk = 1e-6;
constexpr double probe_seconds = 0.5;
constexpr std::uint64_t probe_particles = 4000;
constexpr std::size_t most_probes = 5;

/// Linear between the points, constant beyond them.
template <class Points>
double interpolate(const Points& points, double x) {
  if (x <= points.front().first) return points.front().second;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto [x0, y0] = points[i - 1];
    const auto [x1, y1] = points[i];
    if (x <= x1) return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
  }
  return points.back().second;
}

double reference_nanoseconds(const Config& config) {
  const double eta = config.system.packing_fraction;
  const bool driven = config.drive.kind != DriveKind::none;
  return (driven ? interpolate(driven_nanoseconds, eta) : interpolate(undriven_nanoseconds, eta)) *
         interpolate(size_factor, std::log10(static_cast<double>(config.system.particles)));
}

/// Collisions per disk in the windows of study/calibrate: two rough ones and, mostly, five more.
double calibration_length(const Config& config) {
  if (config.drive.kind == DriveKind::none) return 0;
  constexpr double rough = 2, fine = 5, error = 0.002;
  const double disks = static_cast<double>(config.system.particles);
  const double relaxation = 4 / (3 * (1 - config.collision.restitution * config.collision.restitution));
  const double wanted = std::fmax(error, 0.05 / std::sqrt(disks));
  const double window = std::clamp(relaxation / (disks * wanted * wanted), 25.0, 5e3);
  const double settle = config.system.packing_fraction > 0.78 ? config.run.equilibrate : 0;
  return settle + (rough + fine) * 5 * relaxation + (rough / 2 + fine) * window;
}

double preparation_seconds(const Config& config) {
  const double per_disk =
      config.prepare.method == PrepareMethod::quench ? quench_seconds_per_disk : insert_seconds_per_disk;
  return per_disk * static_cast<double>(config.system.particles);
}

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
  const Config whole = config;
  for (std::uint64_t particles = probe_particles; particles < whole.system.particles; ++particles) {
    config.system.particles = particles;
    try {
      check_config(config);
      return config;
    } catch (const InputError&) {  // these are not whole disks of each species, or their box is too small
    }
  }
  return whole;
}

struct Unseen {
  [[nodiscard]] static double next_sample() { return std::numeric_limits<double>::infinity(); }
  void sample(const Frame&) {}
  void merge(const Unseen&) {}
  static std::vector<Field> fields() { return {}; }
  static std::vector<Dataset> results() { return {}; }
};

/// This machine's time per collision at a state point, in units of the table's.
double probe(const Config& campaign_point) {
  const Config config = small_version(campaign_point);
  const double beat = beat_of(config);
  Simulation simulation(make_start(config));
  std::uint64_t beats = 0;
  const auto collisions_per_disk = [&] {
    return 2 * static_cast<double>(simulation.tally().collisions()) / static_cast<double>(simulation.size());
  };
  const auto rate_over = [&](std::uint64_t more) {
    const double before = collisions_per_disk(), began = static_cast<double>(beats) * beat;
    simulation.run_until(static_cast<double>(beats += more) * beat);
    return (collisions_per_disk() - before) / (static_cast<double>(beats) * beat - began);
  };
  rate_over(10);
  if (config.drive.kind != DriveKind::none && !config.drive.frequency) {  // as often as it collides: what costs time
    State state = simulation.state();
    const double rate = rate_over(10);
    change_drive(state, rate, state.drive.amplitude * std::sqrt(state.drive.frequency / rate));
    beats -= 10;
    simulation = Simulation(std::move(state));
    rate_over(5);
  }
  const double rate = std::fmax(rate_over(10), 0.1 / beat);
  const double interval = std::fmax(config.run.collisions / static_cast<double>(config.run.intervals), 2.0) / rate;
  Measurement measurement(simulation.state(), beat);
  measurement.begin(plan_measurement(static_cast<double>(beats) * beat, interval, config.run.intervals, 1 / rate,
                                     config.observe.lags_per_decade, config.observe.wavenumbers),
                    simulation.tally());
  Unseen nothing;
  const std::uint64_t before = simulation.tally().collisions();
  const double began = processor_seconds();
  double used = 0;
  while (used < probe_seconds) {
    if (static_cast<double>(beats + 1) * beat >= measurement.plan().end()) break;
    measurement.run_until(simulation, static_cast<double>(++beats) * beat, nothing);
    used = processor_seconds() - began;
  }
  const auto collisions = static_cast<double>(simulation.tally().collisions() - before);
  if (!(collisions > 0)) return 1;
  return 1e9 * used / collisions / reference_nanoseconds(config);
}

}  // namespace

double reference_seconds(const Config& config) {
  const double length = calibration_length(config) + config.run.equilibrate + config.run.collisions;
  const double collisions = length * static_cast<double>(config.system.particles) / 2;
  return preparation_seconds(config) + 1e-9 * collisions * reference_nanoseconds(config);
}

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
  return reference_seconds(config) * interpolate(factors, config.system.packing_fraction);
}

double pace_uncertainty(std::span<const Config> configs) {
  constexpr double small = 0.3, large = 0.5;
  double all = 0, uncertain = 0;
  for (const Config& config : configs) {
    const double seconds = reference_seconds(config);
    all += seconds;
    uncertain += seconds * (config.system.particles > 20000 ? large : small);
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
    pace.factors.emplace_back(eta, probe(config));
  }
  report_progress(progress, "probing the speed of this machine", 1);
  return pace;
}

}  // namespace sandglass
