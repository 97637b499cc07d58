// A run in a process of its own.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sandglass {

/// Starts a program with an argument vector (its own name first), without a shell: in a process group of its own (what
/// is typed at the terminal does not reach it), its output appended to `log`, no input. It is sent SIGTERM when this
/// process dies, however that happens. Throws RunError. \pre no other threads
pid_t start_process(const std::string& program, const std::vector<std::string>& arguments,
                    const std::filesystem::path& log);

/// How a process ended: by an exit code or by a signal.
struct ProcessEnd {
  int exit_code = 0, signal = 0;
};

/// How it ended, if it has.
std::optional<ProcessEnd> ended(pid_t process);

/// The last line with anything in it of a file from byte `start` on, of reasonable length; empty if there is none.
std::string last_line(const std::filesystem::path& file, std::uintmax_t start);

}  // namespace sandglass
