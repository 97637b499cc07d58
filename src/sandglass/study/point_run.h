// One run at work (run_point.cc has its stages, point_checkpoint.cc how it is kept, taken up again and watched).
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "sandglass/dynamics/simulation.h"
#include "sandglass/dynamics/watch.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/study/calibrate.h"
#include "sandglass/study/frame_writer.h"
#include "sandglass/study/measurement.h"
#include "sandglass/study/run_place.h"
#include "sandglass/study/run_point.h"
#include "sandglass/study/start.h"
#include "sandglass/study/summarise.h"

namespace sandglass {

/// What is kept in checkpoints changes with this number.
inline constexpr std::uint64_t checkpoint_format = 4;

/// Refuses to go on with a run of another configuration, `held`.
void check_same_run(const Config& config, const Config& held, const RunFolder& folder);

/// From its start or its last checkpoint to its end, through calibration, equilibration and measurement.
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
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  void restore_measurement(const Checkpoint& checkpoint);
  void restore_trajectory(const State& state) const;
  void begin_calibrating(State start);
  void calibrate();
  void begin_equilibrating(State start);
  void equilibrate();
  void begin_measuring();
  bool measure();
  void advance_one_beat();
  void watched_beat(const std::function<void()>& advance);
  void watched(const std::function<void()>& act);
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

}  // namespace sandglass
