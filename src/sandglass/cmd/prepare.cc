// sandglass prepare: only the initial state.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/cmd/text.h"
#include "sandglass/core/errors.h"
#include "sandglass/io/config.h"
#include "sandglass/io/state_file.h"
#include "sandglass/study/start.h"

namespace sandglass {

int prepare_command(int argc, char** argv) {
  std::string config_file, output;
  std::vector<std::string> assignments;
  CLI::App app{"Makes the initial state of a configuration and stores it, for prepare.method = \"file\".",
               "sandglass prepare"};
  app.add_option("config", config_file, "configuration (TOML)")->required();
  app.add_option("-o,--output", output, "file to write, such as start.h5")->required();
  app.add_option("--set", assignments, "set a key, as in --set run.seed=7; repeatable")->expected(1)->take_all();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  const Config config = read_config(config_file, assignments);
  if (std::filesystem::exists(output))
    throw InputError(fmt::format("{} exists already and is not overwritten: remove it or choose another name", output));
  const auto began = std::chrono::steady_clock::now();
  State state;
  {
    ProgressBar bar;
    state = make_start(config, [&](std::string_view stage, double fraction) { bar.show(stage, fraction); });
  }
  write_state(output, state);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  fmt::print("{} disks at packing fraction {:.6g} in a box of side {:.6g}, prepared in {}: {}\n", state.size(),
             packing_fraction(state), state.box_length, duration_text(seconds), output);
  return static_cast<int>(ExitCode::done);
}

}  // namespace sandglass
