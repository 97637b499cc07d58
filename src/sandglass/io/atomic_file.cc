#include "sandglass/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "sandglass/core/errors.h"

namespace sandglass {

void fail_to_write(const std::filesystem::path& path, int code) {
  const std::string problem = fmt::format("cannot write {}: {}", path.string(), std::strerror(code));
  switch (code) {
    case ENOSPC:
    case EDQUOT:
      throw RunError(problem + "; make room and start again with --resume");
    case EACCES:
    case EROFS:
    case EPERM:
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case ENAMETOOLONG:
      throw InputError(problem + "; choose a folder that exists and can be written");
    default:
      throw RunError(problem);
  }
}

namespace {

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : path_(path), fd_(::open(path.c_str(), flags, 0666)) {
    if (fd_ < 0) fail_to_write(path_, errno);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { ::close(fd_); }

  void write(std::string_view contents) const {
    while (!contents.empty()) {
      const ssize_t written = ::write(fd_, contents.data(), contents.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail_to_write(path_, errno);
      contents.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() const {
    // Some file systems cannot sync a folder and say EINVAL; there is then nothing better to do.
    if (::fsync(fd_) != 0 && errno != EINVAL) fail_to_write(path_, errno);
  }

 private:
  const std::filesystem::path& path_;
  int fd_;
};

}  // namespace

void sync_file(const std::filesystem::path& path) { Descriptor(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC).sync(); }

void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write,
                  const std::function<void()>& before_rename) {
  const std::filesystem::path temporary = path.string() + ".partial";
  std::error_code error;
  std::filesystem::remove(temporary, error);  // of a run that was killed, or a pipe, which would keep us waiting
  try {
    write(temporary);
    sync_file(temporary);
    if (before_rename) before_rename();
    std::filesystem::rename(temporary, path, error);
    if (error) fail_to_write(path, error.value());
  } catch (...) {
    std::filesystem::remove(temporary, error);
    throw;
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  Descriptor(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC).sync();
}

void write_whole(const std::filesystem::path& path, std::string_view contents) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    Descriptor(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC).write(contents);
  });
}

std::string read_whole(const std::filesystem::path& path, std::size_t limit) {
  std::error_code error;
  // A pipe or a device could keep us waiting for ever.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("{} is a folder, a pipe or a device; give a file", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(fmt::format("cannot read {}: {}; check the path", path.string(), std::strerror(errno)));
  }
  std::string text;
  std::vector<char> piece(std::min<std::size_t>(limit + 1, 1 << 16));
  while (file && text.size() <= limit) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw InputError(fmt::format("cannot read {}: {}", path.string(), std::strerror(errno)));
  if (text.size() > limit) {
    throw InputError(fmt::format("{} is longer than {} bytes: this is not the file meant", path.string(), limit));
  }
  return text;
}

}  // namespace sandglass
