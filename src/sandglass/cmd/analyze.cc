// sandglass analyze: the measurements of a run, on stored frames.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/core/errors.h"
#include "sandglass/report/report.h"
#include "sandglass/study/analyse.h"

namespace sandglass {
namespace {

void add_options(CLI::App& app, AnalysisOptions& options) {
  app.add_option("--from", options.from, "first frame used, counted from 0")->check(CLI::NonNegativeNumber);
  app.add_option("--stride", options.stride, "use every so manieth frame")->check(CLI::PositiveNumber);
  app.add_option("--blocks", options.blocks, "parts whose scatter gives the errors (default: 10, or 2 of few frames)");
  app.add_option("--radii", options.frames.radii, "radii of the species by name, in the file's unit, as in 1,1.43")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  app.add_option("--timestep", options.frames.timestep, "time between steps, for files without times")
      ->check(CLI::PositiveNumber);
  app.add_option("--wavenumbers", options.wavenumbers, "of the scattering functions, in 1/R_s (default: 0.5,3)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  app.add_option("--lags-per-decade", options.lags_per_decade, "density of the time lags")
      ->check(CLI::Range(1.0, 100.0));
  app.add_option("--overlap-length", options.overlap_length, "of Q(t) and chi_4(t), in R_s")
      ->check(CLI::PositiveNumber);
  app.add_option("--selection-time", options.selection_time,
                 "at which fast and slow disks are told apart (default: a block)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--exponent-range", options.exponent_range,
                 "times between which the exponent of the MSD is fitted (default: 1,10)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  app.add_option("--bin-width", options.bin_width, "of g(r), in R_s (default: L / 800)")
      ->check(CLI::Range(0.001, 1000.0));
}

/// The command as it was given.
std::string command_line(int argc, char** argv) {
  std::string text = "sandglass analyze";
  for (int i = 1; i < argc; ++i) text.append(" ").append(argv[i]);
  return text;
}

}  // namespace

int analyze_command(int argc, char** argv) {
  std::filesystem::path trajectory, folder;
  bool force = false;
  AnalysisOptions options;
  CLI::App app{"Measures what stored frames allow: a trajectory of this program, H5MD, extended XYZ, or a LAMMPS dump.",
               "sandglass analyze"};
  app.add_option("trajectory", trajectory, "file with frames that are evenly spaced in time")->required();
  app.add_option("-o,--output", folder, "folder for the results (default: analysis beside the trajectory)");
  app.add_flag("--force", force, "replace the results that the folder holds");
  add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  if (!(options.exponent_range[0] < options.exponent_range[1]))
    throw InputError("--exponent-range needs two times, the earlier one first, as in 1,10");
  if (folder.empty()) folder = trajectory.parent_path() / "analysis";
  std::error_code error;
  if (std::filesystem::exists(folder / "config.toml", error))
    throw InputError(fmt::format("{} holds a run, whose results would be overwritten: choose another folder with -o",
                                 folder.string()));
  if (!force && std::filesystem::exists(folder / "summary.json", error))
    throw InputError(fmt::format("{} holds results already: give --force to replace them, or another folder with -o",
                                 folder.string()));
  try_all_frames(trajectory, options.frames);  // what cannot be read is refused before a folder is made
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{} cannot be made: {}", folder.string(), error.message()));
  {
    ProgressBar bar;
    const Analysis analysis =
        analyse(trajectory, folder, options, [&](std::string_view stage, double done) { bar.show(stage, done); });
    write_analysis_report(folder, analysis.summary, analysis.last, command_line(argc, argv));
  }
  fmt::print("Results: {}\nReport: {}\n", (folder / "summary.json").string(), (folder / "report.html").string());
  return static_cast<int>(ExitCode::done);
}

}  // namespace sandglass
