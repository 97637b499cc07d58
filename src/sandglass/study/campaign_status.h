// How far a campaign has come: a pure read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sandglass/study/manifest.h"

namespace sandglass {

enum class PointState : std::uint8_t { done, running, stopped, failed, not_started };

/// The word for a state: "done", "running", "stopped", "failed", "not started".
std::string_view name_of(PointState state);

struct PointStatus {
  PointState state = PointState::not_started;
  double fraction = 0;                            ///< of equilibration and measurement; 1 when done
  std::string stage;                              ///< what it does, or did last
  std::string remark;                             ///< of the stage; of a failed point, why
  std::optional<double> collisions_per_second{};  ///< of a finished run
  std::optional<double> wall_seconds{};           ///< that a finished run took
  std::optional<double> seconds_left{};           ///< of a running one
};

/// The state of the run in a folder. Looks at files and at the system's table of locks, opens nothing to write, takes
/// no lock. Locks of other machines are not always to be seen: a run with the lock file there is also taken for running
/// if another host wrote progress.json in the last two minutes.
PointStatus status_of(const std::filesystem::path& folder);

/// Whether a process holds the lock of the run in the folder, as above.
bool is_running(const std::filesystem::path& folder);

}  // namespace sandglass
