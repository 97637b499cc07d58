#include "sandglass/study/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"

namespace sandglass {
namespace {

/// What the new process does before it becomes the program; only calls that are safe after a fork. Signals are blocked
/// until it has forgotten how its parent handles them: one that asks to stop would be taken note of and be lost.
[[noreturn]] void become(const char* program, char* const* arguments, int log, pid_t parent,
                         const sigset_t& unblocked) {
  ::setpgid(0, 0);
  for (const int asks_to_stop : {SIGTERM, SIGINT, SIGUSR1}) ::signal(asks_to_stop, SIG_DFL);
  ::sigprocmask(SIG_SETMASK, &unblocked, nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  constexpr int resumable = 75;
  if (::getppid() != parent) ::_exit(resumable);  // it died before it could be watched
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::execv(program, arguments);
  constexpr int not_started = 127;
  ::_exit(not_started);
}

}  // namespace

pid_t start_process(const std::string& program, const std::vector<std::string>& arguments,
                    const std::filesystem::path& log) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_NONBLOCK | O_CLOEXEC, 0666);
  if (output < 0) fail_to_write(log, errno);
  const pid_t parent = ::getpid();
  sigset_t all, unblocked;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &unblocked);
  const pid_t child = ::fork();
  if (child == 0) become(program.c_str(), words.data(), output, parent, unblocked);
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &unblocked, nullptr);
  ::close(output);
  if (child < 0) throw RunError(fmt::format("cannot start a process: {}", std::strerror(error)));
  return child;
}

std::optional<ProcessEnd> ended(pid_t process) {
  int status = 0;
  const pid_t changed = ::waitpid(process, &status, WNOHANG);
  if (changed == 0 || (changed < 0 && errno == EINTR)) return std::nullopt;
  if (changed < 0) return ProcessEnd{.exit_code = 1, .signal = 0};
  if (WIFSIGNALED(status)) return ProcessEnd{.exit_code = 0, .signal = WTERMSIG(status)};
  return ProcessEnd{.exit_code = WEXITSTATUS(status), .signal = 0};
}

std::string last_line(const std::filesystem::path& file, std::uintmax_t start) {
  constexpr std::uintmax_t window = 4096;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || size <= start) return "";
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(std::max(start, size > window ? size - window : 0)));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t\r") != line.npos) last = line;
  return last;
}

}  // namespace sandglass
