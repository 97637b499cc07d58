// One run, from a configuration to the files in its folder.
#pragma once

#include <functional>

#include "sandglass/core/progress.h"
#include "sandglass/io/config.h"
#include "sandglass/io/run_folder.h"
#include "sandglass/io/summary.h"

namespace sandglass {

/// How a run speaks to whoever waits for it, and how it is asked to stop. All may be empty.
struct RunMonitor {
  Progress progress;
  std::function<bool()> stop_requested;  ///< asked at every beat
};

enum class RunOutcome {
  finished,          ///< all files are written
  already_finished,  ///< nothing to do: the folder holds this run, done
  stopped            ///< at a checkpoint, on request; can be resumed
};

struct RunResult {
  RunOutcome outcome = RunOutcome::finished;
  Summary summary;  ///< empty when stopped
};

/// Prepares, calibrates, equilibrates and measures the state point of `config`, and writes config.toml, checkpoint.h5,
/// trajectory.h5, observables.h5, summary.json and run.log into `folder`. With `resume` it goes on from the checkpoint
/// there, to the same bits as a run that was never stopped; without a checkpoint it starts. Re-entrant: touches nothing
/// but its folder. Throws InputError (bad input, a checkpoint of another run) or RunError (full disk).
RunResult run_point(const Config& config, RunFolder& folder, bool resume, const RunMonitor& monitor = {});

}  // namespace sandglass
