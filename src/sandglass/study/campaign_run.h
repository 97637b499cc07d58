// A campaign on this machine: one process per run, as many at a time as there are cores.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sandglass/study/manifest.h"

namespace sandglass {

/// How far the campaign is; `fraction` weighs points by what they are expected to cost.
struct CampaignProgress {
  std::size_t points = 0, done = 0, running = 0, elsewhere = 0, failed = 0;
  double fraction = 0;
};

struct CampaignMonitor {
  std::function<void(const CampaignProgress&)> progress;  ///< called a few times a second
  std::function<void(const std::string&)> message;        ///< a sentence about a point
  std::function<bool()> stop_requested;
};

struct FailedPoint {
  std::uint64_t index;
  std::string path, reason;
};

struct CampaignResult {
  CampaignProgress progress;
  std::vector<FailedPoint> failed;
  bool stopped = false;
};

/// Cores that this process may use, two threads of one core counted once.
std::size_t usable_cores();

/// Starts `program` run --manifest MANIFEST --index I for every point that is not finished, longest expected first, at
/// most `jobs` at a time (0: one per core, fewer where runs have several threads) and no more than memory holds. What a
/// run prints goes to output.log in its folder. A failed point does not stop the others; one that was killed or stopped
/// is started again while it gets further. A point whose lock another process holds is that one's: it is waited for, so
/// that several campaigns may work in one folder. When asked to stop it asks the runs to, and waits for their
/// checkpoints. When it dies itself, the runs are asked to stop by the system. \pre no other threads
CampaignResult run_campaign(const std::filesystem::path& manifest_file, std::size_t jobs,
                            const CampaignMonitor& monitor, const std::string& program = "/proc/self/exe");

}  // namespace sandglass
