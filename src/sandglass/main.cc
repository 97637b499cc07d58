// sandglass: driven granular fluids, exactly.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "sandglass/cmd/commands.h"
#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"

namespace {

struct Command {
  std::string_view name;
  int (*run)(int argc, char** argv);
  std::string_view summary;
};

constexpr Command commands[] = {
    {"run", sandglass::run_command, "simulate and measure one state point"},
    {"prepare", sandglass::prepare_command, "make only the initial state"},
    {"analyze", sandglass::analyze_command, "the same measurements on stored frames"},
    {"sweep", sandglass::sweep_command, "campaigns: many state points, here or on a cluster"},
    {"figures", sandglass::figures_command, "the figures of a run or a study"},
    {"bench", sandglass::bench_command, "measure the speed of the engine, and check it"},
    {"info", sandglass::info_command, "version, machine, and all configuration keys"},
};

void print_usage(std::FILE* out) {
  fmt::print(out, "sandglass {}: exact event-driven simulation of driven granular fluids\n\nUsage:\n",
             sandglass::version);
  for (const Command& command : commands) fmt::print(out, "  sandglass {:<9}{}\n", command.name, command.summary);
  fmt::print(out,
             "\nsandglass COMMAND --help tells the options. A first run:\n"
             "  sandglass run examples/quick.toml -o runs/quick\n");
}

int dispatch(int argc, char** argv) {
  const std::string_view name = argc > 1 ? argv[1] : "";
  if (name == "--help" || name == "-h" || name == "help") {
    print_usage(stdout);
    return 0;
  }
  if (name == "--version") {
    fmt::print("sandglass {}\n", sandglass::version);
    return 0;
  }
  for (const Command& command : commands)
    if (command.name == name) return command.run(argc - 1, argv + 1);
  if (!name.empty()) fmt::print(stderr, "sandglass: there is no command \"{}\"\n\n", name);
  print_usage(stderr);
  return static_cast<int>(sandglass::ExitCode::bad_input);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return dispatch(argc, argv);
  } catch (const sandglass::InputError& error) {
    fmt::print(stderr, "sandglass: {}\n", error.what());
    return static_cast<int>(sandglass::ExitCode::bad_input);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr,
               "sandglass: out of memory: use fewer particles (system.particles), or a machine with more memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "sandglass: {}\n", error.what());
  }
  return static_cast<int>(sandglass::ExitCode::failure);
}
