// How a run is kept and taken up again, and what is left when its self-check fails.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/trajectory.h"
#include "sandglass/study/point_run.h"

namespace sandglass {

void check_same_run(const Config& config, const Config& held, const RunFolder& folder) {
  const std::vector<std::string> differing = differing_keys(config, held);
  if (differing.empty()) return;
  throw InputError(
      fmt::format("{} holds a checkpoint or run with other values of: {}. A resumed run must be the same run: give the "
                  "same values, or choose another folder with -o",
                  folder.path().string(), fmt::join(differing, ", ")));
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
  std::vector<FieldGroup> kept = measurement_->fields();
  kept.push_back({"frames", frames_->fields()});
  kept.push_back({"calibration", facts_.calibration.fields()});
  restore_fields(checkpoint, kept);
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

void PointRun::checkpoint_now_and_then() {
  if (seconds_since(last_checkpoint_) >= config_.output.checkpoint_seconds) write_checkpoint_now();
}

void PointRun::write_checkpoint_now() {
  // A checkpoint is good: what had failed before the disks were copied is found, and what fails later is not in it.
  const State state = simulation().state();
  watched([this] { watch_.inspect(simulation()); });
  facts_.wall_seconds = earlier_wall_seconds_ + seconds_since(started_);
  std::vector<FieldGroup> kept;
  if (calibrator_) {
    kept.push_back({"calibrator", calibrator_->fields()});
  } else {
    kept = measurement_->fields();
    kept.push_back(measurement_->plan_fields());
    kept.push_back({"frames", frames_->fields()});
    kept.push_back({"calibration", facts_.calibration.fields()});
    frames_->sync();
  }
  kept.push_back(own_fields());
  write_checkpoint(folder_.checkpoint(), state, config_to_toml(config_), kept);
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

void PointRun::watched_beat(const std::function<void()>& advance) {
  watched([&] {
    watch_.before_beat(simulation());
    advance();
    watch_.after_beat(simulation());
  });
}

void PointRun::watched(const std::function<void()>& act) try { act(); } catch (const Violation& violation) {
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

}  // namespace sandglass
