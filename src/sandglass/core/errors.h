// The errors that a user sees. Each message says the problem, why it is one, and what to do.
#pragma once

#include <stdexcept>
#include <string>

namespace sandglass {

/// Exit codes of the program, a contract with schedulers and scripts.
enum class ExitCode : int { done = 0, failure = 1, bad_input = 2, resumable = 75 };

/// What the user gave cannot be used: a key, a value, a file, a folder. Exit code 2; nothing has been touched.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The run could not go on for a reason outside the input: a full disk, a violated invariant. Exit code 1.
struct RunError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace sandglass
