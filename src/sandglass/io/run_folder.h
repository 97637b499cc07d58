// The output folder of a run: recognised, locked, never overwritten by accident.
#pragma once

#include <filesystem>
#include <vector>

namespace sandglass {

/// What is to become of a run that the folder already holds.
enum class FolderMode { fresh, force, resume };

/// Holds the lock on the folder while it lives. A folder holds a run if there is a config.toml in it. Opening one does
/// not touch what is in it; if begin() is never called (the start file turned out to be bad, say) the folders that
/// opening made are removed again.
class RunFolder {
 public:
  /// Makes the folder where there is none and locks it. Throws InputError when another process runs in it, when it
  /// holds a run and the mode is `fresh`, when it is no folder or cannot be written.
  static RunFolder open(const std::filesystem::path& path, FolderMode mode);

  RunFolder(RunFolder&&) noexcept;
  RunFolder& operator=(RunFolder&&) = delete;
  ~RunFolder();

  /// The run begins: from here on the folder stays. With `force` the files of the run before are removed (those that
  /// this program writes, by name; nothing else).
  void begin();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool holds_run() const;  ///< there is a config.toml or a checkpoint

  [[nodiscard]] std::filesystem::path config() const { return path_ / "config.toml"; }
  [[nodiscard]] std::filesystem::path summary() const { return path_ / "summary.json"; }
  [[nodiscard]] std::filesystem::path observables() const { return path_ / "observables.h5"; }
  [[nodiscard]] std::filesystem::path trajectory() const { return path_ / "trajectory.h5"; }
  [[nodiscard]] std::filesystem::path checkpoint() const { return path_ / "checkpoint.h5"; }
  [[nodiscard]] std::filesystem::path report() const { return path_ / "report.html"; }
  [[nodiscard]] std::filesystem::path start() const { return path_ / "start.h5"; }  ///< until the run is finished
  /// What a run leaves that its self-check has stopped.
  [[nodiscard]] std::filesystem::path diagnostic() const { return path_ / "diagnostic.txt"; }
  [[nodiscard]] std::filesystem::path diagnostic_state() const { return path_ / "diagnostic.h5"; }
  [[nodiscard]] std::filesystem::path log() const { return path_ / "run.log"; }
  /// In a campaign: how far the run is, and what it printed.
  [[nodiscard]] std::filesystem::path progress() const { return path_ / "progress.json"; }
  [[nodiscard]] std::filesystem::path output_log() const { return path_ / "output.log"; }

 private:
  RunFolder(std::filesystem::path path, FolderMode mode) : path_(std::move(path)), mode_(mode) {}
  void lock();
  void refuse_if_held() const;

  std::filesystem::path path_;
  FolderMode mode_;
  std::vector<std::filesystem::path> made_;  ///< folders that open() made, outermost first
  int lock_ = -1;                            ///< descriptor of the lock file
  bool begun_ = false;
};

}  // namespace sandglass
