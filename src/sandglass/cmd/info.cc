// sandglass info: what this program and this machine are.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <thread>

#include "sandglass/cmd/commands.h"
#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/io/config.h"

namespace sandglass {

int info_command(int argc, char** argv) {
  bool keys = false;
  CLI::App app{"Tells version and machine, or all configuration keys.", "sandglass info"};
  app.add_flag("--keys", keys, "the reference of all configuration keys, as a Markdown table");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  if (keys) {
    fmt::print("{}", config_reference());
  } else {
    fmt::print("sandglass {}\ninstruction set of the engine: {}\ncores: {}\n", version, Simulation::instruction_set(),
               std::thread::hardware_concurrency());
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace sandglass
