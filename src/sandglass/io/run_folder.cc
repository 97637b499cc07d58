#include "sandglass/io/run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/io/checkpoint.h"

namespace sandglass {
namespace {

/// The folders on the way to `path` that do not exist yet, outermost first.
std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> missing;
  std::error_code error;
  for (auto folder = path; !folder.empty() && !std::filesystem::exists(folder, error); folder = folder.parent_path()) {
    missing.insert(missing.begin(), folder);
  }
  return missing;
}

std::filesystem::path without_trailing_slash(const std::filesystem::path& path) {
  const auto normal = path.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

RunFolder RunFolder::open(const std::filesystem::path& path, FolderMode mode) {
  if (path.empty()) throw InputError("the name of the output folder is empty: give one with -o");
  RunFolder folder(without_trailing_slash(path), mode);
  std::error_code error;
  if (std::filesystem::exists(folder.path_, error) && !std::filesystem::is_directory(folder.path_, error)) {
    throw InputError(fmt::format("{} is a file, not a folder: give another with -o", path.string()));
  }
  folder.made_ = missing_folders(folder.path_);
  std::filesystem::create_directories(folder.path_, error);
  if (error) {
    throw InputError(
        fmt::format("cannot make the folder {}: {}; give another with -o", path.string(), error.message()));
  }
  folder.lock();
  folder.refuse_if_held();
  return folder;
}

/// Takes the lock. The holder removes the file when it goes, so one that was opened just before may be gone by the time
/// it is locked: then it is tried again.
void RunFolder::lock() {
  const std::filesystem::path file = path_ / ".lock";
  for (;;) {
    lock_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) {
      throw InputError(
          fmt::format("cannot write in the folder {}: {}; give another with -o", path_.string(), std::strerror(errno)));
    }
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
      const int code = errno;
      ::close(std::exchange(lock_, -1));
      if (code == EINTR) continue;
      throw InputError(
          fmt::format("the folder {} is in use by another run: wait for it or give another with -o", path_.string()));
    }
    struct stat locked {
    }, named{};
    const bool same = ::fstat(lock_, &locked) == 0 && ::stat(file.c_str(), &named) == 0 &&
                      locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
    if (same) return;
    ::close(std::exchange(lock_, -1));
  }
}

void RunFolder::refuse_if_held() const {
  if (mode_ != FolderMode::fresh || !holds_run()) return;
  throw InputError(
      fmt::format("the folder {} holds a run already: go on with it by --resume, replace it by --force, or "
                  "give another folder with -o",
                  path_.string()));
}

bool RunFolder::holds_run() const {
  std::error_code error;
  return std::filesystem::exists(config(), error) || has_checkpoint(checkpoint());
}

void RunFolder::begin() {
  begun_ = true;
  if (mode_ != FolderMode::force) return;
  // config.toml goes last: until then the folder is known as a run.
  const std::array files{start(),       diagnostic(), diagnostic_state(), summary(),
                         observables(), trajectory(), checkpoint(),       previous_checkpoint(checkpoint()),
                         report(),      log(),        progress(),         output_log(),
                         config()};
  for (const auto& file : files) {
    std::error_code error;
    std::filesystem::remove(file, error);
    if (error) {
      throw InputError(
          fmt::format("cannot remove {}: {}; give another folder with -o", file.string(), error.message()));
    }
    std::filesystem::remove(file.string() + ".partial", error);
  }
}

RunFolder::RunFolder(RunFolder&& other) noexcept
    : path_(std::move(other.path_)),
      mode_(other.mode_),
      made_(std::exchange(other.made_, {})),
      lock_(std::exchange(other.lock_, -1)),
      begun_(std::exchange(other.begun_, true)) {}

RunFolder::~RunFolder() {
  std::error_code error;
  if (lock_ >= 0) {
    std::filesystem::remove(path_ / ".lock", error);
    ::close(lock_);
  }
  if (begun_) return;
  // Removes a folder only if it is empty.
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) std::filesystem::remove(*folder, error);
}

}  // namespace sandglass
