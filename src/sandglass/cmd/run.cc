// sandglass run: one state point, from the configuration to the report.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/interrupt.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/cmd/text.h"
#include "sandglass/core/errors.h"
#include "sandglass/io/config.h"
#include "sandglass/io/config_table.h"
#include "sandglass/io/run_folder.h"
#include "sandglass/report/report.h"
#include "sandglass/study/manifest.h"
#include "sandglass/study/run_point.h"
#include "sandglass/study/run_progress.h"

namespace sandglass {
namespace {

struct Arguments {
  std::string config, folder;
  std::vector<std::string> assignments;
  bool resume = false, force = false, paranoid = false;
  std::string manifest;
  std::uint64_t index = 0, count = 1;  // of the points of the manifest
};

// "0.8123(45)" style is for papers; here value and error stand side by side.
std::string with_error(double value, double error) {
  if (std::isnan(value)) return "not reached";
  return std::isnan(error) ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} +- {:.2g}", value, error);
}

double error_of(const Summary& summary, std::string_view name) {
  for (const auto& [key, error] : summary.errors)
    if (key == name) return error;
  return Summary::unknown;
}

void print_summary(const Summary& s, const RunFolder& folder) {
  const auto line = [](std::string_view what, const std::string& value) { fmt::print("  {:<34}{}\n", what, value); };
  fmt::print("\n{} disks, packing fraction {:.4g}, restitution {:.4g}, seed {}\n", s.particles, s.packing_fraction,
             s.restitution, s.seed);
  line("measured", fmt::format("{:.4g} time units, {:.4g} collisions per disk", s.time, s.collisions_per_particle));
  line("temperature T", with_error(s.temperature.all, error_of(s, "temperature_all")));
  line("small / big disks T_s / T_b", fmt::format("{:.4g} / {:.4g} = {:.4f}", s.temperature.small, s.temperature.big,
                                                  s.temperature.small / s.temperature.big));
  line("collisions per disk and time", with_error(s.collision_rate, error_of(s, "collision_rate")));
  line("compressibility factor pV/NT", with_error(s.compressibility_factor, error_of(s, "compressibility_factor")));
  if (!std::isnan(s.msd_exponent.small.value))
    line(fmt::format("MSD exponent, {:g} < t < {:g}, small", s.msd_exponent.small.from, s.msd_exponent.small.to),
         with_error(s.msd_exponent.small.value, s.msd_exponent.small.error));
  line("small disks move by R_s in t =", with_error(s.msd_unit_time.small, error_of(s, "msd_unit_time_small")));
  line("stationary", s.stationary ? "yes" : "not shown (see below)");
  line("speed", fmt::format("{:.3g} million collisions/s, {} in all", s.collisions_per_second / 1e6,
                            duration_text(s.wall_seconds)));
  line("state", s.state_hash);
  for (const std::string& warning : s.warnings) fmt::print("Note: {}\n", warning);
  fmt::print("Report: {}\n", folder.report().string());
}

Arguments parse(int argc, char** argv, int& exit_code) {
  Arguments arguments;
  std::string threads, max_walltime;
  CLI::App app{"Simulates and measures one state point.", "sandglass run"};
  auto* config = app.add_option("config", arguments.config, "configuration (TOML); all keys: sandglass info --keys");
  auto* folder = app.add_option("-o,--output", arguments.folder,
                                "folder for the results (default: runs/NAME of the configuration)");
  app.add_option("--set", arguments.assignments, "set a key, as in --set run.seed=7; after the file, repeatable")
      ->expected(1)
      ->take_all();
  app.add_option("--threads", threads, "short for --set run.threads=N");
  app.add_option("--max-walltime", max_walltime, "seconds; short for --set run.max_walltime_seconds=T");
  app.add_flag("--paranoid", arguments.paranoid, "short for --set run.self_check=every_event (slow)");
  auto* resume =
      app.add_flag("--resume", arguments.resume, "go on from the checkpoint in the folder; start if there is none");
  auto* force = app.add_flag("--force", arguments.force, "replace the run that the folder holds")->excludes("--resume");
  auto* manifest =
      app.add_option("--manifest", arguments.manifest, "instead of a configuration: points of a campaign (sweep init)");
  auto* index = app.add_option("--index", arguments.index, "the point to run or go on with, from 1")->needs(manifest);
  app.add_option("--count", arguments.count, "that many points from there, one after another")
      ->needs(manifest)
      ->check(CLI::PositiveNumber);
  manifest->excludes(config)->excludes(folder)->excludes(resume)->excludes(force)->needs(index);
  exit_code = -1;
  try {
    app.parse(argc, argv);
    if (config->empty() && manifest->empty()) throw CLI::RequiredError("a configuration, or --manifest with --index:");
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  if (!threads.empty()) arguments.assignments.push_back(fmt::format("run.threads={}", threads));
  if (!max_walltime.empty()) arguments.assignments.push_back(fmt::format("run.max_walltime_seconds={}", max_walltime));
  if (arguments.paranoid) arguments.assignments.push_back("run.self_check=every_event");
  if (arguments.folder.empty())
    arguments.folder = (std::filesystem::path("runs") / std::filesystem::path(arguments.config).stem()).string();
  return arguments;
}

using Clock = std::chrono::steady_clock;

/// Carries one run to its report and says so. `file`, if there is one, is told of the progress.
ExitCode carry_out(const Config& config, RunFolder& folder, bool resume, const std::function<bool()>& stop_requested,
                   ProgressFile* file = nullptr) {
  RunResult result;
  {
    ProgressBar bar;
    const auto show = [&](std::string_view stage, double fraction) {
      bar.show(stage, fraction);
      if (file != nullptr) file->show(stage, fraction);
    };
    result = run_point(config, folder, resume, {.progress = show, .stop_requested = stop_requested});
  }
  if (result.outcome == RunOutcome::stopped) {
    if (file != nullptr) file->stopped();
    return ExitCode::resumable;
  }
  if (result.outcome == RunOutcome::already_finished) fmt::print("This run is finished already; nothing was done.\n");
  if (result.outcome == RunOutcome::finished || !std::filesystem::exists(folder.report())) write_report(folder.path());
  print_summary(result.summary, folder);
  return ExitCode::done;
}

/// One point of a campaign, whatever was done of it before. Its wall-time limit counts from `began`, when the first of
/// them was started.
ExitCode run_row(const Manifest& manifest, const ManifestRow& row, const Arguments& arguments, Clock::time_point began,
                 bool first) {
  const std::filesystem::path path = manifest.run_folder(row);
  if (!std::filesystem::is_directory(path))
    throw InputError(fmt::format("point {} of the manifest has no folder {}: make it by sandglass sweep init",
                                 row.index, path.string()));
  RunFolder folder = RunFolder::open(path, FolderMode::resume);
  const bool was_finished = std::filesystem::exists(folder.summary());
  std::optional<ProgressFile> file;
  try {
    Config config = read_point(manifest, row);
    for (const std::string& assignment : arguments.assignments) set_key(assignment, config);
    file.emplace(path, config);
    const double limit = config.run.max_walltime_seconds;
    const auto stop_requested = [&] {
      return stop_signal_came() || (limit > 0 && std::chrono::duration<double>(Clock::now() - began).count() >= limit);
    };
    // A limit too short to begin at all is an error of the first point; the others have what is left of it.
    if (!first) config.run.max_walltime_seconds = 0;
    const ExitCode code = carry_out(config, folder, true, stop_requested, was_finished ? nullptr : &*file);
    if (code == ExitCode::done) file->finished();
    if (code == ExitCode::resumable)
      fmt::print("Stopped. Go on with: sandglass run --manifest {} --index {}\n", shell_word(arguments.manifest),
                 row.index);
    return code;
  } catch (const std::exception& error) {
    if (!file) file.emplace(path, Config{});
    file->failed(error.what());
    throw;
  }
}

/// `count` points of the manifest from `index` on, or as many as there are. One that fails does not stop the others;
/// one that was stopped does: the time is over for all.
int run_rows(const Arguments& arguments) {
  const Manifest manifest = read_manifest(arguments.manifest);
  find_row(manifest, arguments.index);
  const auto began = Clock::now();
  bool first = true;
  int worst = static_cast<int>(ExitCode::done);
  const auto failed = [&](const ManifestRow& row, const std::exception& error, ExitCode code) {
    fmt::print(stderr, "sandglass: point {}: {}\n", row.index, error.what());
    worst = std::max(worst, static_cast<int>(code));
  };
  for (const ManifestRow& row : manifest.rows) {
    if (row.index < arguments.index || row.index - arguments.index >= arguments.count) continue;
    try {
      const ExitCode code = run_row(manifest, row, arguments, began, std::exchange(first, false));
      if (code == ExitCode::resumable) return static_cast<int>(ExitCode::resumable);
    } catch (const InputError& error) {
      failed(row, error, ExitCode::bad_input);
    } catch (const std::exception& error) {
      failed(row, error, ExitCode::failure);
    }
  }
  return worst;
}

}  // namespace

int run_command(int argc, char** argv) {
  int exit_code = 0;
  const Arguments arguments = parse(argc, argv, exit_code);
  if (exit_code >= 0) return exit_code;
  catch_stop_signals();
  if (!arguments.manifest.empty()) return run_rows(arguments);

  const Config config = read_config(arguments.config, arguments.assignments);
  RunFolder folder = RunFolder::open(arguments.folder, arguments.resume  ? FolderMode::resume
                                                       : arguments.force ? FolderMode::force
                                                                         : FolderMode::fresh);
  const ExitCode code = carry_out(config, folder, arguments.resume, stop_signal_came);
  if (code == ExitCode::resumable) {
    // What was set stands in the folder's configuration, once there is one.
    const bool begun = folder.holds_run();
    std::string again = shell_word(begun ? folder.config().string() : arguments.config);
    if (!begun)
      for (const std::string& assignment : arguments.assignments) again += " --set " + shell_word(assignment);
    fmt::print("Stopped. Go on with: sandglass run {} -o {} --resume\n", again, shell_word(arguments.folder));
  }
  return static_cast<int>(code);
}

}  // namespace sandglass
