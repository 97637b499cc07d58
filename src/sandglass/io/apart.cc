#include "sandglass/io/apart.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <type_traits>
#include <vector>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"

namespace sandglass {
namespace {

constexpr std::size_t longest_message = 1 << 16;
constexpr int succeeded = 0, has_message = 2;
const std::string lost = "lost what the process that reads a file has read";

/// A file in memory that both processes see, for the State or the message.
class SharedFile {
 public:
  SharedFile() : descriptor_(memfd_create("sandglass", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw RunError("no memory for reading a file");
  }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  ~SharedFile() { ::close(descriptor_); }
  [[nodiscard]] std::filesystem::path path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

/// What crosses: a header, then a row for each disk. Neither has padding.
struct Header {
  double box_length = 0;
  Mixture mixture;
  std::uint64_t disks = 0;
};
struct Row {
  double x = 0, y = 0, vx = 0, vy = 0;
  std::int32_t image_x = 0, image_y = 0;
  std::uint64_t species = 0;
};
static_assert(std::is_trivially_copyable_v<Header> && sizeof(Header) == 6 * 8 && sizeof(Row) == 6 * 8);

void send(const std::filesystem::path& to, const State& state) {
  const Header header{state.box_length, state.mixture, state.size()};
  std::vector<Row> rows;
  rows.reserve(state.size());
  for (const Disk& d : state.disks) rows.push_back({d.x, d.y, d.vx, d.vy, d.image_x, d.image_y, d.species});
  std::ofstream file(to, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof header);
  file.write(reinterpret_cast<const char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof(Row)));
  if (!file.flush()) throw RunError("no memory for reading a file");
}

State receive(const std::filesystem::path& from) {
  std::ifstream file(from, std::ios::binary);
  Header header;
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (header.disks > std::filesystem::file_size(from) / sizeof(Row)) throw RunError(lost);
  std::vector<Row> rows(header.disks);
  file.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof(Row)));
  if (!file) throw RunError(lost);
  State state;
  state.box_length = header.box_length;
  state.mixture = header.mixture;
  state.disks.resize(rows.size());
  for (std::size_t id = 0; id < rows.size(); ++id) {
    Disk& disk = state.disks[id];
    disk.x = rows[id].x, disk.y = rows[id].y, disk.vx = rows[id].vx, disk.vy = rows[id].vy;
    disk.image_x = rows[id].image_x, disk.image_y = rows[id].image_y;
    disk.species = static_cast<Species>(rows[id].species);
  }
  return state;
}

void limit(decltype(RLIMIT_CPU) resource, rlim_t soft) {
  rlimit limits{};
  getrlimit(resource, &limits);
  limits.rlim_cur = std::min(soft, limits.rlim_max);
  setrlimit(resource, &limits);
}

/// Pages of data that this process has now; the reader may use so much more.
std::size_t data_pages() {
  std::size_t pages = 0;
  std::ifstream statm("/proc/self/statm");
  for (int column = 0; column < 6; ++column) statm >> pages;
  return pages;
}

/// Generous for any honest file: a State takes a few times the bytes of a frame, and is read in seconds.
void limit_resources(std::size_t file_bytes) {
  constexpr std::size_t megabyte = 1 << 20, fast_enough = 20 * megabyte;
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, 5 + file_bytes / fast_enough);
  limit(RLIMIT_DATA, data_pages() * static_cast<std::size_t>(getpagesize()) + 1024 * megabyte + 16 * file_bytes);
}

int read_in_child(const std::filesystem::path& result, const std::function<void()>& read) {
  std::string message;
  try {
    read();
    return succeeded;
  } catch (const InputError& error) {
    message = error.what();
  } catch (const std::exception&) {
    return 1;
  }
  std::ofstream(result, std::ios::binary) << message;
  return has_message;
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw RunError("lost the process that reads a file");
  }
  return status;
}

/// Calls `read` in a child, which may write to `result` what it has read. Throws InputError unless it comes to its end.
void call_apart(const std::filesystem::path& path, const std::filesystem::path& result,
                const std::function<void()>& read) {
  std::error_code error;
  const std::size_t file_bytes = std::filesystem::file_size(path, error);
  const pid_t child = fork();
  if (child < 0) throw RunError("cannot start a process to read a file: too many processes, or no memory");
  if (child == 0) {
    limit_resources(error ? 0 : file_bytes);
    _exit(read_in_child(result, read));
  }
  const int status = wait_for(child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == succeeded) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == has_message) throw InputError(read_whole(result, longest_message));
  throw InputError(
      fmt::format("{} is damaged: the HDF5 library {} on reading it; use another copy", path.string(),
                  WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU ? "did not come to an end" : "failed"));
}

}  // namespace

State read_apart(const std::filesystem::path& path, const std::function<State()>& read) {
  const SharedFile shared;
  call_apart(path, shared.path(), [&] { send(shared.path(), read()); });
  return receive(shared.path());
}

void try_apart(const std::filesystem::path& path, const std::function<void()>& read) {
  const SharedFile shared;
  call_apart(path, shared.path(), read);
}

}  // namespace sandglass
