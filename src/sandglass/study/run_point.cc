#include "sandglass/study/run_point.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <optional>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/dynamics/start_check.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/trajectory.h"
#include "sandglass/study/calibrate.h"
#include "sandglass/study/measurement.h"
#include "sandglass/study/start.h"
#include "sandglass/study/summarise.h"

namespace sandglass {
namespace {

using Clock = std::chrono::steady_clock;

/// Thrown out of preparation and calibration when the run is asked to stop: nothing is lost, they start anew.
struct Stopped {};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// An Observer that stores the frames of the trajectory, evenly spaced over the measured stretch, both ends included.
class FrameWriter {
 public:
  FrameWriter(std::filesystem::path path, std::uint64_t frames, double box_length)
      : path_(std::move(path)), frames_(frames), box_length_(box_length) {}

  void begin(const MeasurementPlan& plan) { plan_ = plan; }

  [[nodiscard]] double next_sample() const {
    if (!plan_ || written_ >= frames_) return std::numeric_limits<double>::infinity();
    if (frames_ == 1) return plan_->end();
    const double step = (plan_->end() - plan_->start) / static_cast<double>(frames_ - 1);
    return written_ + 1 == frames_ ? plan_->end() : plan_->start + static_cast<double>(written_) * step;
  }
  void sample(const Frame& frame) {
    const double collisions = frame.collisions_per_disk * static_cast<double>(frame.size()) / 2;
    write_frame(path_, written_++, std::llround(collisions), frame, box_length_);
  }
  void merge(const FrameWriter&) {}  // two trajectories stay two files
  [[nodiscard]] std::vector<Field> fields() { return {{"written", &written_}}; }
  [[nodiscard]] std::vector<Dataset> results() const { return {}; }

 private:
  std::filesystem::path path_;
  std::uint64_t frames_, written_ = 0;
  double box_length_;
  std::optional<MeasurementPlan> plan_;
};
static_assert(Observer<FrameWriter>);

class PointRun {
 public:
  PointRun(const Config& config, RunFolder& folder, const RunMonitor& monitor)
      : config_(config), folder_(folder), monitor_(monitor), beat_(beat_of(config)) {}

  void start();
  void resume();
  /// Whether the run came to its end (and was not asked to stop).
  bool go();
  Summary finish();

 private:
  void calibrate_drive(State& state, const Progress& progress);
  void equilibrate();
  void begin_measuring();
  bool measure();
  void advance_one_beat();
  [[nodiscard]] bool equilibrated() const;
  [[nodiscard]] double collisions_per_disk() const;
  [[nodiscard]] bool counts_collisions() const;
  [[nodiscard]] bool stop_requested() const { return monitor_.stop_requested && monitor_.stop_requested(); }
  void report(const char* stage, double fraction);
  void checkpoint_now_and_then();
  void write_checkpoint_now();
  [[nodiscard]] FieldGroup own_fields();
  void log(const std::string& line) const;

  const Config& config_;
  RunFolder& folder_;
  const RunMonitor& monitor_;
  const double beat_;
  const Tuning tuning_{.threads = threads_for(config_.system.particles, config_.run.threads)};

  std::optional<Simulation> simulation_;
  std::optional<Measurement> measurement_;
  std::optional<FrameWriter> frames_;
  RunFacts facts_;

  std::uint64_t beats_ = 0;           // done since t = 0
  std::uint64_t measuring_ = 0;       // 1 once equilibration is over
  std::uint64_t first_beat_ = 0;      // of the measured stretch
  std::uint64_t measured_beats_ = 0;  // length of the measured stretch
  // s at the last two powers of two of beats. The collision rate of the fluid is taken from the earlier mark on: over
  // the last half to three quarters of equilibration, whatever its length.
  struct Marks {
    std::uint64_t early_beats = 0, late_beats = 1;
    double early_collisions = 0, late_collisions = 0;
  } marks_;
  double earlier_wall_seconds_ = 0, engine_seconds_ = 0;
  Clock::time_point started_ = Clock::now(), last_checkpoint_ = Clock::now();
};

void PointRun::start() {
  // What may still be refused is refused before the folder is touched.
  const Progress progress = [this](std::string_view stage, double fraction) {
    if (stop_requested()) throw Stopped{};
    report_progress(monitor_.progress, stage, fraction);
  };
  State state = make_start(config_, progress);
  check_start(state);
  folder_.begin();
  write_whole(folder_.config(), config_to_toml(config_));
  log("initial state prepared");
  if (state.drive.kind != DriveKind::none) calibrate_drive(state, progress);
  if (config_.output.trajectory_frames > 0)
    create_trajectory(folder_.trajectory(), state, config_.output.trajectory_frames);
  frames_.emplace(folder_.trajectory(), config_.output.trajectory_frames, state.box_length);
  measurement_.emplace(state, beat_);
  simulation_.emplace(std::move(state), tuning_);
}

void PointRun::calibrate_drive(State& state, const Progress& progress) {
  CalibrationGoal goal{.temperature = config_.drive.temperature, .frequency = config_.drive.frequency, .beat = beat_};
  goal.threads = tuning_.threads;
  // Above 0.78 the collision rate ages for long: calibrate an aged copy, or T would drift from the start.
  if (config_.system.packing_fraction > 0.78) goal.settle = config_.run.equilibrate;
  facts_.calibration = calibrate(state, goal, progress);
  state.drive.frequency = facts_.calibration.frequency;
  state.drive.amplitude = facts_.calibration.amplitude;
  start_kick_clocks(state);
  log(fmt::format("drive calibrated in {} windows: frequency {}, amplitude {}", facts_.calibration.windows,
                  state.drive.frequency, state.drive.amplitude));
}

void PointRun::resume() {
  const State probe = read_checkpoint(folder_.checkpoint(), {own_fields()}).state;
  measurement_.emplace(probe, beat_);
  frames_.emplace(folder_.trajectory(), config_.output.trajectory_frames, probe.box_length);
  read_checkpoint(folder_.checkpoint(), {measurement_->plan_fields()});
  measurement_->prepare_restore(measuring_ == 1);
  std::vector<FieldGroup> groups = measurement_->fields();
  groups.push_back({"frames", frames_->fields()});
  Checkpoint checkpoint = read_checkpoint(folder_.checkpoint(), groups);
  measurement_->finish_restore();
  if (measuring_ == 1) frames_->begin(measurement_->plan());
  if (config_.output.trajectory_frames > 0 && !std::filesystem::exists(folder_.trajectory())) {
    create_trajectory(folder_.trajectory(), probe, config_.output.trajectory_frames);
    log("trajectory.h5 was gone: made again, without the frames before this point");
  }
  earlier_wall_seconds_ = facts_.wall_seconds;
  simulation_.emplace(std::move(checkpoint.state), tuning_);
  log(fmt::format("resumed at beat {}{}", beats_,
                  checkpoint.from_previous ? " from the previous checkpoint (the newest was damaged)" : ""));
}

bool PointRun::go() {
  if (measuring_ == 0) {
    equilibrate();
    if (stop_requested()) {
      write_checkpoint_now();
      return false;
    }
    begin_measuring();
  }
  return measure();
}

/// Undriven inelastic disks cool: their collisions per time fall without end, so lengths are counted in initial mean
/// free times there, in collisions per disk everywhere else.
bool PointRun::counts_collisions() const {
  return config_.drive.kind != DriveKind::none || config_.collision.restitution == 1;
}

double PointRun::collisions_per_disk() const {
  return 2.0 * static_cast<double>(simulation_->tally().collisions()) / static_cast<double>(simulation_->size());
}

bool PointRun::equilibrated() const {
  return (counts_collisions() ? collisions_per_disk() : static_cast<double>(beats_)) >= config_.run.equilibrate;
}

void PointRun::equilibrate() {
  while (!equilibrated() && !stop_requested()) {
    advance_one_beat();
    if (beats_ == 2 * marks_.late_beats) {
      marks_ = {marks_.late_beats, beats_, marks_.late_collisions, collisions_per_disk()};
    }
    const double done = counts_collisions() ? collisions_per_disk() : static_cast<double>(beats_);
    report("equilibrating", done / config_.run.equilibrate);
    checkpoint_now_and_then();
  }
}

void PointRun::begin_measuring() {
  double rate = 1 / beat_;
  if (facts_.calibration.windows > 0) rate = facts_.calibration.collision_rate;
  if (counts_collisions() && marks_.early_beats > 1)
    rate =
        (collisions_per_disk() - marks_.early_collisions) / (static_cast<double>(beats_ - marks_.early_beats) * beat_);
  // The stretch is whole beats, however it is cut into intervals: these change what is measured, not the trajectory.
  measured_beats_ = static_cast<std::uint64_t>(std::ceil(config_.run.collisions / (rate * beat_)));
  first_beat_ = beats_;
  const double start = static_cast<double>(first_beat_) * beat_;
  const double end = static_cast<double>(first_beat_ + measured_beats_) * beat_;
  const auto intervals = static_cast<double>(config_.run.intervals);
  double interval = (end - start) / intervals;
  while (start + intervals * interval > end) interval = std::nextafter(interval, 0.0);  // no sample after the last beat
  const MeasurementPlan plan = plan_measurement(start, interval, config_.run.intervals, 1 / rate,
                                                config_.observe.lags_per_decade, config_.observe.wavenumbers);
  measurement_->begin(plan, simulation_->tally());
  frames_->begin(plan);
  facts_.start_energy = kinetic_energy(simulation_->state());
  measuring_ = 1;
  log(fmt::format("equilibrated after {} collisions per disk; measuring {} beats", collisions_per_disk(),
                  measured_beats_));
}

bool PointRun::measure() {
  while (beats_ - first_beat_ < measured_beats_) {
    if (stop_requested()) {
      write_checkpoint_now();
      return false;
    }
    advance_one_beat();
    const std::uint64_t done = beats_ - first_beat_;
    report("measuring", static_cast<double>(done) / static_cast<double>(measured_beats_));
    if (done < measured_beats_) checkpoint_now_and_then();
  }
  return true;
}

void PointRun::advance_one_beat() {
  const auto start = Clock::now();
  ++beats_;
  measurement_->run_until(*simulation_, static_cast<double>(beats_) * beat_, *frames_);
  engine_seconds_ += seconds_since(start);
}

void PointRun::report(const char* stage, double fraction) {
  if (!monitor_.progress) return;
  const double rate = static_cast<double>(simulation_->tally().collisions()) / std::max(engine_seconds_, 1e-9);
  monitor_.progress(fmt::format("{} ({:.2f} million collisions/s)", stage, rate / 1e6), std::min(fraction, 1.0));
}

void PointRun::checkpoint_now_and_then() {
  if (seconds_since(last_checkpoint_) >= config_.output.checkpoint_seconds) write_checkpoint_now();
}

void PointRun::write_checkpoint_now() {
  facts_.wall_seconds = earlier_wall_seconds_ + seconds_since(started_);
  std::vector<FieldGroup> groups = measurement_->fields();
  groups.push_back(measurement_->plan_fields());
  groups.push_back({"frames", frames_->fields()});
  groups.push_back(own_fields());
  write_checkpoint(folder_.checkpoint(), simulation_->state(), config_to_toml(config_), groups);
  write_observables(folder_.observables(), measurement_->results());
  last_checkpoint_ = Clock::now();
}

FieldGroup PointRun::own_fields() {
  Calibration& c = facts_.calibration;
  return {"run",
          {{"beats", &beats_},
           {"measuring", &measuring_},
           {"first_beat", &first_beat_},
           {"measured_beats", &measured_beats_},
           {"early_beats", &marks_.early_beats},
           {"late_beats", &marks_.late_beats},
           {"early_collisions", &marks_.early_collisions},
           {"late_collisions", &marks_.late_collisions},
           {"start_energy", &facts_.start_energy},
           {"wall_seconds", &facts_.wall_seconds},
           {"engine_seconds", &engine_seconds_},
           {"calibration_frequency", &c.frequency},
           {"calibration_amplitude", &c.amplitude},
           {"calibration_temperature_error", &c.temperature_error},
           {"calibration_collision_rate", &c.collision_rate},
           {"calibration_windows", &c.windows},
           {"calibration_converged", &c.converged}}};
}

Summary PointRun::finish() {
  const State end = simulation_->state();
  facts_.end_energy = kinetic_energy(end);
  facts_.threads = simulation_->threads();
  write_checkpoint_now();
  facts_.collisions_per_second = static_cast<double>(end.tally.collisions()) / std::max(engine_seconds_, 1e-9);
  Summary summary = summarise(config_, end, *measurement_, facts_);
  write_summary(folder_.summary(), summary);
  log(fmt::format("finished, state {}", summary.state_hash));
  return summary;
}

void PointRun::log(const std::string& line) const {
  std::ofstream file(folder_.log(), std::ios::app);
  file << fmt::format("{:%Y-%m-%d %H:%M:%S} UTC  {}\n", fmt::gmtime(std::time(nullptr)), line);
}

/// Refuses to go on with a run of another configuration.
void check_same_run(const Config& config, const RunFolder& folder) {
  const std::vector<std::string> differing = differing_keys(config, read_config(folder.config()));
  if (differing.empty()) return;
  throw InputError(fmt::format(
      "{} holds a run with other values of: {}. A resumed run must be the same run: give the same values, or choose "
      "another folder with -o",
      folder.path().string(), fmt::join(differing, ", ")));
}

}  // namespace

RunResult run_point(const Config& config, RunFolder& folder, bool resume, const RunMonitor& monitor) {
  PointRun run(config, folder, monitor);
  const bool held = resume && folder.holds_run();
  if (held) check_same_run(config, folder);
  if (held && std::filesystem::exists(folder.summary()))
    return {RunOutcome::already_finished, read_summary(folder.summary())};
  if (held && has_checkpoint(folder.checkpoint()))
    run.resume();
  else
    try {
      run.start();
    } catch (const Stopped&) {
      return {RunOutcome::stopped, {}};
    }
  if (!run.go()) return {RunOutcome::stopped, {}};
  return {RunOutcome::finished, run.finish()};
}

}  // namespace sandglass
