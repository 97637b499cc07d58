#include "sandglass/study/campaign_status.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "sandglass/core/errors.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/summary.h"
#include "sandglass/study/run_progress.h"

namespace sandglass {
namespace {

/// Whether /proc/locks has a flock on the file. Lines are "1: FLOCK  ADVISORY  WRITE pid major:minor:inode 0 EOF". The
/// device is not compared: some file systems show another one there than stat does.
bool in_table_of_locks(ino_t inode) {
  std::ifstream table("/proc/locks");
  const std::string end = fmt::format(":{}", inode);
  for (std::string line; std::getline(table, line);)
    if (line.find(" FLOCK ") != line.npos && line.find(end + ' ') != line.npos) return true;
  return false;
}

/// Network file systems make record locks of a flock, and those can be asked for.
bool has_record_lock(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  const bool held = ::fcntl(descriptor, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  ::close(descriptor);
  return held;
}

/// Whether another machine wrote of its progress lately.
bool works_elsewhere(const std::filesystem::path& folder) {
  constexpr auto lately = std::chrono::minutes(2);
  const auto progress = read_progress(folder);
  if (!progress || progress->host == this_host()) return false;
  std::error_code error;
  const auto written = std::filesystem::last_write_time(progress_file(folder), error);
  return !error && std::filesystem::file_time_type::clock::now() - written < lately;
}

PointStatus status_of_finished(const std::filesystem::path& summary_file) {
  PointStatus status{.state = PointState::done, .fraction = 1, .stage = "done", .remark = ""};
  try {
    const Summary summary = read_summary(summary_file);
    status.collisions_per_second = summary.collisions_per_second;
    status.wall_seconds = summary.wall_seconds;
  } catch (const InputError& error) {
    status.remark = error.what();
  }
  return status;
}

}  // namespace

std::string_view name_of(PointState state) {
  switch (state) {
    case PointState::done:
      return "done";
    case PointState::running:
      return "running";
    case PointState::stopped:
      return "stopped";
    case PointState::failed:
      return "failed";
    case PointState::not_started:
      break;
  }
  return "not started";
}

bool is_running(const std::filesystem::path& folder) {
  struct stat lock {};
  if (::stat((folder / ".lock").c_str(), &lock) != 0) return false;  // its holder removes it
  return in_table_of_locks(lock.st_ino) || has_record_lock(folder / ".lock") || works_elsewhere(folder);
}

PointStatus status_of(const std::filesystem::path& folder) {
  const bool running = is_running(folder);
  if (!running && std::filesystem::exists(folder / "summary.json")) return status_of_finished(folder / "summary.json");
  PointStatus status;
  const auto progress = read_progress(folder);
  if (progress) {
    status.fraction = progress->fraction;
    status.stage = progress->stage;
    status.remark = progress->remark;
  }
  if (running) {
    status.state = PointState::running;
    if (progress) status.seconds_left = progress->seconds_left;
  } else if (progress && progress->stage == "failed") {
    status.state = PointState::failed;
  } else if (progress || has_checkpoint(folder / "checkpoint.h5")) {
    status.state = PointState::stopped;
  }
  return status;
}

}  // namespace sandglass
