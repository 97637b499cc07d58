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
#include "sandglass/core/version.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/dynamics/start_check.h"
#include "sandglass/dynamics/watch.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/trajectory.h"
#include "sandglass/study/calibrate.h"
#include "sandglass/study/frame_writer.h"
#include "sandglass/study/measurement.h"
#include "sandglass/study/run_place.h"
#include "sandglass/study/start.h"
#include "sandglass/study/summarise.h"

namespace sandglass {
namespace {

using Clock = std::chrono::steady_clock;

/// What is kept in checkpoints changes with this number.
constexpr std::uint64_t checkpoint_format = 3;

/// Thrown out of the preparation when the run is asked to stop. There is nothing yet to go on from: it starts anew.
struct Stopped {};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Refuses to go on with a run of another configuration, `held`.
void check_same_run(const Config& config, const Config& held, const RunFolder& folder) {
  const std::vector<std::string> differing = differing_keys(config, held);
  if (differing.empty()) return;
  throw InputError(
      fmt::format("{} holds a checkpoint or run with other values of: {}. A resumed run must be the same run: give the "
                  "same values, "
                  "or choose another folder with -o",
                  folder.path().string(), fmt::join(differing, ", ")));
}

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
  void restore_measurement(const Checkpoint& checkpoint);
  void restore_trajectory(const State& state) const;
  void begin_calibrating(State start);
  void calibrate();
  void begin_equilibrating(State start);
  void equilibrate();
  void begin_measuring();
  bool measure();
  void advance_one_beat();
  template <class Advance>
  void watched_beat(Advance&& advance);
  template <class Act>
  void watched(Act&& act);
  void report_violation(const Violation& violation);
  [[nodiscard]] bool equilibrated() const;
  [[nodiscard]] double collisions_per_disk() const;
  [[nodiscard]] bool counts_collisions() const;
  [[nodiscard]] State start_state(const Progress& progress) const;
  [[nodiscard]] Simulation& simulation() { return calibrator_ ? calibrator_->simulation() : *simulation_; }
  [[nodiscard]] bool stop_requested() const;
  void report(const char* stage, double fraction);
  void checkpoint_now_and_then();
  void write_checkpoint_now();
  [[nodiscard]] FieldGroup own_fields();
  void log(const std::string& line) const;

  const Config& config_;
  RunFolder& folder_;
  const RunMonitor& monitor_;
  const double beat_;
  const Config calibrated_{calibration_config(config_)};
  const Tuning tuning_{.threads = threads_for(config_.system.particles, config_.run.threads)};

  std::optional<Calibrator> calibrator_;  // only while it is at work: afterwards there is the simulation
  std::optional<Simulation> simulation_;
  std::optional<Measurement> measurement_;
  std::optional<FrameWriter> frames_;
  Watch watch_{config_.run.self_check};
  RunFacts facts_;

  std::uint64_t format_ = checkpoint_format;
  RunPlace place_;
  double earlier_wall_seconds_ = 0, engine_seconds_ = 0;
  Clock::time_point started_ = Clock::now(), last_checkpoint_ = Clock::now();
};

bool PointRun::stop_requested() const {
  const double most = config_.run.max_walltime_seconds;
  return (monitor_.stop_requested && monitor_.stop_requested()) || (most > 0 && seconds_since(started_) >= most);
}

/// The initial state, made anew if need be: always the same bits.
State PointRun::start_state(const Progress& progress) const {
  try {
    if (std::filesystem::exists(folder_.start())) return read_state(folder_.start());
  } catch (const InputError& error) {
    log(fmt::format("{}; the start is prepared again", error.what()));
  }
  return make_start(config_, progress);
}

void PointRun::start() {
  // What may still be refused is refused before the folder is touched.
  const Progress progress = [this](std::string_view stage, double fraction) {
    if (stop_requested()) throw Stopped{};
    report_progress(monitor_.progress, stage, fraction);
  };
  State start = make_start(config_, progress), to_calibrate;
  check_start(start);
  if (calibrated_.system.particles < start.size()) to_calibrate = make_start(calibrated_, progress);
  folder_.begin();
  write_whole(folder_.config(), config_to_toml(config_));
  log("initial state prepared");
  if (start.drive.kind == DriveKind::none) return begin_equilibrating(std::move(start));
  write_state(folder_.start(), start);
  begin_calibrating(to_calibrate.size() > 0 ? std::move(to_calibrate) : std::move(start));
}

void PointRun::begin_calibrating(State start) {
  CalibrationGoal goal{.temperature = config_.drive.temperature, .frequency = config_.drive.frequency, .beat = beat_};
  goal.threads = threads_for(calibrated_.system.particles, config_.run.threads);
  // Above 0.78 the collision rate ages for long: calibrate an aged copy, or T would drift from the start.
  if (config_.system.packing_fraction > 0.78) goal.settle = config_.run.equilibrate;
  calibrator_.emplace(std::move(start), goal);
  place_.calibrating = 1;
}

void PointRun::calibrate() {
  while (!calibrator_->done() && !stop_requested()) {
    report_progress(monitor_.progress, "calibrating the drive", calibrator_->fraction());
    watched_beat([this] { calibrator_->advance_one_beat(); });
    if (calibrator_->window_over()) watched([this] { watch_.inspect(simulation()); });  // the drive is set by it
    if (calibrator_->end_window()) watch_ = Watch(config_.run.self_check);
    checkpoint_now_and_then();
  }
  facts_.calibration = calibrator_->result();
}

void PointRun::begin_equilibrating(State start) {
  if (calibrator_) {
    const Calibration& found = facts_.calibration;
    start.drive.frequency = found.frequency;
    start.drive.amplitude = found.amplitude;
    start_kick_clocks(start);
    log(fmt::format("drive calibrated in {} windows: frequency {}, amplitude {}", found.windows, found.frequency,
                    found.amplitude));
    calibrator_.reset();
    place_.calibrating = 0;
  }
  if (config_.output.trajectory_frames > 0)
    create_trajectory(folder_.trajectory(), start, config_.output.trajectory_frames);
  frames_.emplace(folder_.trajectory(), config_.output.trajectory_frames, start.box_length);
  measurement_.emplace(start, beat_);
  simulation_.emplace(std::move(start), tuning_);
  watch_ = Watch(config_.run.self_check);
}

void PointRun::resume() {
  Checkpoint checkpoint = read_checkpoint(folder_.checkpoint(), {{"run", {{"format", &format_}}}});
  if (format_ != checkpoint_format)
    throw InputError(fmt::format(
        "the checkpoint in {} was written by another version of sandglass: finish the run with that one, or "
        "start a new run from its state with prepare.method = \"file\"",
        folder_.path().string()));
  check_same_run(config_, read_config_text(checkpoint.config_toml, "the checkpoint", folder_.path()), folder_);
  if (!std::filesystem::exists(folder_.config())) write_whole(folder_.config(), config_to_toml(config_));
  restore_fields(checkpoint, {own_fields()});
  check_place(place_, checkpoint.state, place_.calibrating == 1 ? calibrated_ : config_, beat_);
  earlier_wall_seconds_ = facts_.wall_seconds;
  const char* from = checkpoint.from_previous ? " from the previous checkpoint (the newest was damaged)" : "";
  if (place_.calibrating == 1) {
    begin_calibrating(std::move(checkpoint.state));
    restore_fields(checkpoint, {{"calibrator", calibrator_->fields()}});
    if (!calibrator_->valid())
      throw InputError("the checkpoint is damaged: its calibration is at no possible place; start again with --force");
    log(fmt::format("resumed in the calibration of the drive{}", from));
    return;
  }
  restore_measurement(checkpoint);
  simulation_.emplace(std::move(checkpoint.state), tuning_);
  watch_ = Watch(config_.run.self_check);
  log(fmt::format("resumed at beat {}{}", place_.beats, from));
}

void PointRun::restore_measurement(const Checkpoint& checkpoint) {
  const State& state = checkpoint.state;
  measurement_.emplace(state, beat_);
  frames_.emplace(folder_.trajectory(), config_.output.trajectory_frames, state.box_length);
  restore_fields(checkpoint, {measurement_->plan_fields()});
  measurement_->prepare_restore(place_.measuring == 1, config_);
  if (place_.measuring == 1) check_place(place_, measurement_->plan(), beat_);
  std::vector<FieldGroup> groups = measurement_->fields();
  groups.push_back({"frames", frames_->fields()});
  groups.push_back({"calibration", facts_.calibration.fields()});
  restore_fields(checkpoint, groups);
  measurement_->finish_restore(state.time());
  if (place_.measuring == 1) frames_->begin(measurement_->plan());
  if (!frames_->valid(state.time()))
    throw InputError("the checkpoint is damaged: its frames are not those up to its time; start again with --force");
  restore_trajectory(state);
}

void PointRun::restore_trajectory(const State& state) const {
  const std::uint64_t frames = config_.output.trajectory_frames;
  if (frames == 0) return;
  if (!std::filesystem::exists(folder_.trajectory())) {
    create_trajectory(folder_.trajectory(), state, frames);
    log("trajectory.h5 was gone: made again, without the frames before this point");
    return;
  }
  try {
    check_trajectory(folder_.trajectory(), state.size(), frames);
  } catch (const InputError& error) {
    throw InputError(
        fmt::format("{}. Move trajectory.h5 away to go on without the frames before this point", error.what()));
  }
}

bool PointRun::go() {
  if (calibrator_) {
    calibrate();
    if (!calibrator_->done()) {
      write_checkpoint_now();
      return false;
    }
    begin_equilibrating(start_state(monitor_.progress));
  }
  if (place_.measuring == 0) {
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
  return (counts_collisions() ? collisions_per_disk() : static_cast<double>(place_.beats)) >= config_.run.equilibrate;
}

void PointRun::equilibrate() {
  while (!equilibrated() && !stop_requested()) {
    advance_one_beat();
    if (place_.beats == 2 * place_.marks.late_beats) {
      place_.marks = {place_.marks.late_beats, place_.beats, place_.marks.late_collisions, collisions_per_disk()};
    }
    const double done = counts_collisions() ? collisions_per_disk() : static_cast<double>(place_.beats);
    report("equilibrating", done / config_.run.equilibrate);
    checkpoint_now_and_then();
  }
}

void PointRun::begin_measuring() {
  double rate = 1 / beat_;
  if (facts_.calibration.windows > 0) rate = facts_.calibration.collision_rate;
  if (counts_collisions() && place_.marks.early_beats > 1)
    rate = (collisions_per_disk() - place_.marks.early_collisions) /
           (static_cast<double>(place_.beats - place_.marks.early_beats) * beat_);
  // The stretch is whole beats, however it is cut into intervals: these change what is measured, not the trajectory.
  place_.measured_beats = static_cast<std::uint64_t>(std::ceil(config_.run.collisions / (rate * beat_)));
  place_.first_beat = place_.beats;
  const double start = static_cast<double>(place_.first_beat) * beat_;
  const double end = static_cast<double>(place_.first_beat + place_.measured_beats) * beat_;
  const auto intervals = static_cast<double>(config_.run.intervals);
  double interval = (end - start) / intervals;
  while (start + intervals * interval > end) interval = std::nextafter(interval, 0.0);  // no sample after the last beat
  MeasurementPlan plan = plan_measurement(start, interval, config_.run.intervals, 1 / rate,
                                          config_.observe.lags_per_decade, config_.observe.wavenumbers);
  plan.overlap_length = config_.observe.overlap_length;
  plan.selection_time = config_.observe.selection_time;
  plan.bin_width = config_.observe.bin_width;
  plan.structure_frames = config_.observe.structure_frames
                              ? static_cast<std::uint64_t>(*config_.observe.structure_frames)
                              : affordable_structure_frames(plan, 1 / rate);
  measurement_->begin(plan, simulation_->tally());
  frames_->begin(plan);
  facts_.start_energy = kinetic_energy(simulation_->state());
  place_.measuring = 1;
  log(fmt::format("equilibrated after {} collisions per disk; measuring {} beats", collisions_per_disk(),
                  place_.measured_beats));
}

bool PointRun::measure() {
  while (place_.beats - place_.first_beat < place_.measured_beats) {
    if (stop_requested()) {
      write_checkpoint_now();
      return false;
    }
    advance_one_beat();
    const std::uint64_t done = place_.beats - place_.first_beat;
    report("measuring", static_cast<double>(done) / static_cast<double>(place_.measured_beats));
    if (done < place_.measured_beats) checkpoint_now_and_then();
  }
  return true;
}

void PointRun::advance_one_beat() {
  const auto start = Clock::now();
  ++place_.beats;
  watched_beat([this] { measurement_->run_until(*simulation_, static_cast<double>(place_.beats) * beat_, *frames_); });
  engine_seconds_ += seconds_since(start);
}

template <class Advance>
void PointRun::watched_beat(Advance&& advance) {
  watched([&] {
    watch_.before_beat(simulation());
    advance();
    watch_.after_beat(simulation());
  });
}

template <class Act>
void PointRun::watched(Act&& act) try {
  act();
} catch (const Violation& violation) {
  report_violation(violation);
}

/// Leaves for whoever looks for the fault what there is to see, and the last good checkpoint as it is.
void PointRun::report_violation(const Violation& violation) {
  const std::string instructions = has_checkpoint(folder_.checkpoint()) ? "go on from the last checkpoint with --resume"
                                                                        : "start again with --force";
  const std::string report = fmt::format(
      "the self-check has stopped the run: {}. Memory or processor may be failing, or the program is at "
      "fault; nothing that was written is wrong: {}, and if it happens again, report it with {}",
      violation.what(), instructions, folder_.diagnostic().string());
  log(report);
  try {
    write_whole(folder_.diagnostic(), fmt::format("{}\n\nsandglass {}, instruction set {}, beat {}, {} events\n\n{}",
                                                  report, version, Simulation::instruction_set(), place_.beats,
                                                  simulation().tally().collisions(), config_to_toml(config_)));
    write_state(folder_.diagnostic_state(), simulation().state());
  } catch (const std::exception& error) {
    log(error.what());
  }
  throw RunError(report);
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
  watched([this] { watch_.inspect(simulation()); });  // a checkpoint is good
  facts_.wall_seconds = earlier_wall_seconds_ + seconds_since(started_);
  std::vector<FieldGroup> groups;
  if (calibrator_) {
    groups.push_back({"calibrator", calibrator_->fields()});
  } else {
    groups = measurement_->fields();
    groups.push_back(measurement_->plan_fields());
    groups.push_back({"frames", frames_->fields()});
    groups.push_back({"calibration", facts_.calibration.fields()});
    frames_->sync();
  }
  groups.push_back(own_fields());
  write_checkpoint(folder_.checkpoint(), simulation().state(), config_to_toml(config_), groups);
  if (measurement_) write_observables(folder_.observables(), measurement_->results());
  last_checkpoint_ = Clock::now();
}

FieldGroup PointRun::own_fields() {
  FieldGroup own{"run", place_.fields()};
  for (const Field& field : std::initializer_list<Field>{{"format", &format_},
                                                         {"start_energy", &facts_.start_energy},
                                                         {"wall_seconds", &facts_.wall_seconds},
                                                         {"engine_seconds", &engine_seconds_}})
    own.second.push_back(field);
  return own;
}

Summary PointRun::finish() {
  const State end = simulation_->state();
  facts_.end_energy = kinetic_energy(end);
  facts_.threads = simulation_->threads();
  write_checkpoint_now();
  facts_.collisions_per_second = static_cast<double>(end.tally.collisions()) / std::max(engine_seconds_, 1e-9);
  Summary summary = summarise(config_, end, *measurement_, facts_);
  write_summary(folder_.summary(), summary);
  std::error_code error;
  std::filesystem::remove(folder_.start(), error);  // it has served
  log(fmt::format("finished, state {}", summary.state_hash));
  return summary;
}

void PointRun::log(const std::string& line) const {
  std::error_code error;
  const auto status = std::filesystem::status(folder_.log(), error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return;  // a pipe could block us
  std::ofstream file(folder_.log(), std::ios::app);
  file << fmt::format("{:%Y-%m-%d %H:%M:%S} UTC  {}\n", fmt::gmtime(std::time(nullptr)), line);
}

}  // namespace

RunResult run_point(const Config& config, RunFolder& folder, bool resume, const RunMonitor& monitor) {
  PointRun run(config, folder, monitor);
  const bool held = resume && folder.holds_run();
  const bool has_config = std::filesystem::exists(folder.config());
  if (held && has_config) check_same_run(config, read_config(folder.config()), folder);
  if (held && std::filesystem::exists(folder.summary()))
    return {RunOutcome::already_finished, read_summary(folder.summary())};
  if (held && has_checkpoint(folder.checkpoint()))
    run.resume();
  else
    try {
      run.start();
    } catch (const Stopped&) {
      if (monitor.stop_requested && monitor.stop_requested()) return {RunOutcome::stopped, {}};
      throw RunError(fmt::format(
          "run.max_walltime_seconds = {} was over before the start was prepared, and there is nothing to resume from: "
          "allow more, or make the start once with `sandglass prepare` and give it as prepare.file",
          config.run.max_walltime_seconds));
    }
  if (!run.go()) return {RunOutcome::stopped, {}};
  return {RunOutcome::finished, run.finish()};
}

}  // namespace sandglass
