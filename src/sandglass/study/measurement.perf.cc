// What measuring on line costs: two simulations of one trajectory, of which one is measured as a run is by default, go
// on by turns, some 50 ms each, so that what else the machine does slows both alike. What the engine loses because
// samples push its tables out of the cache is in it; preparing, checkpoints and the report are not.
#include "sandglass/study/measurement.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>
#include <utility>

#include "sandglass/study/calibrate.h"
#include "sandglass/study/start.h"

namespace sandglass {
namespace {

constexpr std::uint64_t beats_by_turns = 20, beats_of_equilibration = 200;
constexpr std::uint64_t most_intervals = 1000;            // of a plan; as many as asked for are run
constexpr double collisions_per_disk_of_interval = 1000;  // as in a run of default length

/// 10^4 disks, kicked in pairs.
Config driven_fluid() {
  Config config;
  config.system.packing_fraction = 0.8;
  config.collision.restitution = 0.9;
  config.drive.kind = DriveKind::pair;
  return config;
}

class SideBySide {
 public:
  explicit SideBySide(const Config& config) : beat_(beat_of(config)) {
    State start = make_start(config, {});
    const Calibration calibration = calibrate(start, {.beat = beat_, .temperature_error = 0.01});
    start.drive.frequency = calibration.frequency;
    start.drive.amplitude = calibration.amplitude;
    start_kick_clocks(start);
    measurement_.emplace(start, beat_);
    plain_.emplace(start);
    measured_.emplace(std::move(start));
    go_on_plain(beats_of_equilibration);
    go_on_measuring(beats_of_equilibration);
    beats_ = beats_of_equilibration;

    const double rate = calibration.collision_rate;
    beats_per_interval_ = static_cast<std::uint64_t>(std::ceil(collisions_per_disk_of_interval / (rate * beat_)));
    MeasurementPlan plan =
        plan_measurement(static_cast<double>(beats_) * beat_, static_cast<double>(beats_per_interval_) * beat_,
                         most_intervals, 1 / rate, config.observe.lags_per_decade, config.observe.wavenumbers);
    plan.overlap_length = config.observe.overlap_length;
    plan.structure_frames = most_intervals * 2 / 3;  // as affordable_structure_frames has it
    measurement_->begin(plan, measured_->tally());
  }

  struct Seconds {
    double plain, measured;
  };
  Seconds run_interval() {
    Seconds sum{0, 0};
    for (const std::uint64_t end = beats_ + beats_per_interval_; beats_ < end;) {
      const std::uint64_t next = std::min(end, beats_ + beats_by_turns);
      if (plain_first_) sum.plain += go_on_plain(next);
      sum.measured += go_on_measuring(next);
      if (!plain_first_) sum.plain += go_on_plain(next);
      plain_first_ = !plain_first_;
      beats_ = next;
    }
    return sum;
  }

  [[nodiscard]] bool same_trajectory() const { return state_hash(plain_->state()) == state_hash(measured_->state()); }

 private:
  struct Nobody {  // in place of the frames that a run writes
    [[nodiscard]] double next_sample() const { return INFINITY; }
    void sample(const Frame&) {}
    void merge(const Nobody&) {}
    std::vector<Field> fields() { return {}; }
    [[nodiscard]] std::vector<Dataset> results() const { return {}; }
  };

  /// Goes on beat by beat, and returns the processor time that it took, in seconds.
  template <class RunUntil>
  double go_on(std::uint64_t beats, RunUntil&& run_until) const {
    const std::clock_t begun = std::clock();
    for (std::uint64_t n = beats_ + 1; n <= beats; ++n) run_until(static_cast<double>(n) * beat_);
    return static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  }
  double go_on_plain(std::uint64_t beats) {
    return go_on(beats, [this](double end) { plain_->run_until(end); });
  }
  double go_on_measuring(std::uint64_t beats) {
    return go_on(beats, [this](double end) { measurement_->run_until(*measured_, end, nobody_); });
  }

  double beat_;
  std::optional<Simulation> plain_, measured_;
  std::optional<Measurement> measurement_;
  Nobody nobody_;
  std::uint64_t beats_ = 0, beats_per_interval_ = 0;
  bool plain_first_ = true;
};

/// An iteration is an interval of 1000 collisions per disk. Counters: the time that measuring adds, in per cent of the
/// engine's, over all iterations, and the standard error of that by the scatter of the intervals.
void measuring(benchmark::State& state) {
  static std::optional<SideBySide> pair;  // kept while the library finds out how often to repeat
  if (!pair) pair.emplace(driven_fluid());
  double plain = 0, added = 0, squares = 0, count = 0;
  for (auto iteration : state) {
    const auto seconds = pair->run_interval();
    const double more = seconds.measured - seconds.plain;
    plain += seconds.plain, added += more, squares += more * more, count += 1;
  }
  if (!pair->same_trajectory()) state.SkipWithError("what is measured has gone another way");
  state.counters["percent"] = 100 * added / plain;
  if (count > 1)
    state.counters["error"] = 100 * std::sqrt((squares - added * added / count) * count / (count - 1)) / plain;
}
BENCHMARK(measuring)->Unit(benchmark::kSecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace sandglass
