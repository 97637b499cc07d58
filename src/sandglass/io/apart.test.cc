#include "sandglass/io/apart.h"

#include <doctest/doctest.h>

#include <atomic>
#include <csignal>
#include <limits>
#include <vector>

#include "sandglass/core/errors.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

TEST_CASE("what is read apart comes back with every bit, or with its message") {
  const TemporaryFolder folder;
  spill(folder / "file", "x");
  constexpr double infinity = std::numeric_limits<double>::infinity();
  State state;
  state.box_length = 40.1, state.mixture = sample_state(2).mixture, state.disks = sample_state(1000).disks;
  for (Disk& disk : state.disks)
    disk.time = 0, disk.kick_count = 0, disk.last_contact = -infinity, disk.next_kick = infinity;
  const State again = read_apart(folder / "file", [&] { return state; });
  CHECK(state_hash(again) == state_hash(state));
  CHECK(again.mixture.mass == state.mixture.mass);
  const auto refuse = []() -> State { throw InputError("no such disk"); };
  CHECK(message_of<InputError>([&] { read_apart(folder / "file", refuse); }) == "no such disk");
}

TEST_CASE("a reader that crashes, never ends, or takes all memory is an error in the file") {
  const TemporaryFolder folder;
  const auto path = folder / "file";
  spill(path, "x");
  const auto message = [&](const std::function<State()>& read) {
    return message_of<InputError>([&] { read_apart(path, read); });
  };
  const auto crash = []() -> State {
    std::signal(SIGSEGV, SIG_DFL);
    std::raise(SIGSEGV);
    return {};
  };
  CHECK(message(crash).find(path.string() + " is damaged") == 0);
  const auto loop = []() -> State {
    for (std::atomic<unsigned> turns = 0;;) ++turns;
  };
  CHECK(message(loop).find("did not come to an end") != std::string::npos);
  const auto take_all = []() -> State {
    for (;;) {
      constexpr std::size_t block = 64 << 20;
      new std::vector<char>(block, 'x');  // kept, on purpose
    }
  };
  CHECK(message(take_all).find("is damaged") != std::string::npos);
}
