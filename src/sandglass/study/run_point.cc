#include "sandglass/study/run_point.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/start_check.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/trajectory.h"
#include "sandglass/study/point_run.h"

namespace sandglass {
namespace {

/// Thrown out of the preparation when the run is asked to stop. There is nothing yet to go on from: it starts anew.
struct Stopped {};

}  // namespace

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

void PointRun::report(const char* stage, double fraction) {
  if (!monitor_.progress) return;
  const double rate = static_cast<double>(simulation_->tally().collisions()) / std::max(engine_seconds_, 1e-9);
  monitor_.progress(fmt::format("{} ({:.2f} million collisions/s)", stage, rate / 1e6), std::min(fraction, 1.0));
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
