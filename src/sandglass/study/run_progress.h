// progress.json: how far a run of a campaign has come, for whoever asks without disturbing it.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sandglass/io/config.h"

namespace sandglass {

/// What the file says.
struct RunProgress {
  std::string stage;                   ///< as shown, such as "measuring"; "failed"
  std::string remark;                  ///< of the stage, such as its rate; of a failure, its message
  double fraction = 0;                 ///< of equilibration and measurement together
  std::optional<double> seconds_left;  ///< at the pace of this stage
  std::string host;                    ///< where it runs or ran
};

/// Writes the file of one run now and then while it works: when a stage begins and every `interval` seconds, by a
/// rename, without waiting for the disk. A file that cannot be written is no reason to stop a run.
class ProgressFile {
 public:
  ProgressFile(std::filesystem::path folder, const Config& config, double interval = 10);

  /// For RunMonitor::progress. A remark stands in brackets at the end of the stage.
  void show(std::string_view stage, double fraction);
  void stopped();                           ///< writes where the run stands
  void failed(const std::string& message);  ///< why it ended
  void finished();                          ///< removes the file: the summary tells all

 private:
  using Clock = std::chrono::steady_clock;
  void write() const;

  std::filesystem::path file_;
  double equilibrate_, collisions_, interval_;
  RunProgress progress_;
  double first_fraction_ = 0;
  Clock::time_point stage_began_{}, last_written_{};
};

/// The name of this machine.
std::string this_host();

std::filesystem::path progress_file(const std::filesystem::path& folder);

/// What the file of a run's folder says; nothing if there is none that can be read.
std::optional<RunProgress> read_progress(const std::filesystem::path& folder);

}  // namespace sandglass
