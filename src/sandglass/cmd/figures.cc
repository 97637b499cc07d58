// sandglass figures: the figures of the paper from the runs in a folder.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/core/errors.h"
#include "sandglass/report/figure_files.h"
#include "sandglass/report/figure_json.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/study_page.h"
#include "sandglass/study/collect.h"

namespace sandglass {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string folder, output;
  std::vector<int> only;
  std::vector<std::string> formats{"svg", "pdf", "png"};
};

Arguments parse(int argc, char** argv, int& exit_code) {
  Arguments a;
  CLI::App app{
      "Remakes the figures of the paper (1 to 16) and more (bond order, 17, to 24) from the finished runs under a "
      "folder,\n"
      "each as data (CSV, JSON) and as pictures, and a study's report.html with all of them beside what the paper "
      "says.",
      "sandglass figures"};
  app.add_option("folder", a.folder, "folder of a run or of a study")->required();
  app.add_option("--only", a.only, "numbers of the figures to make, as in --only 5,6")
      ->delimiter(',')
      ->check(CLI::Range(1, figure_count));
  app.add_option("--format", a.formats, "pictures to draw: svg, pdf, png, or none")
      ->delimiter(',')
      ->check(CLI::IsMember({"svg", "pdf", "png", "none"}))
      ->capture_default_str();
  app.add_option("-o,--output", a.output,
                 "folder for figures and report (default: figures go to FOLDER/figures, a "
                 "study's report.html to FOLDER)");
  exit_code = -1;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  std::erase(a.formats, "none");
  return a;
}

void print_verdicts(const std::vector<Figure>& figures) {
  for (const Figure& figure : figures) {
    fmt::print("  {:<16}{}\n", figure.checks.empty() ? "" : outcome_text(verdict(figure)), figure.title);
    if (figure.empty() && !figure.missing.empty()) fmt::print("  {:<16}  {}\n", "", figure.missing);
  }
}

}  // namespace

int figures_command(int argc, char** argv) {
  int exit_code = 0;
  const Arguments arguments = parse(argc, argv, exit_code);
  if (exit_code >= 0) return exit_code;
  Study study;
  {
    ProgressBar bar;
    study = read_study(arguments.folder, [&](std::string_view stage, double fraction) { bar.show(stage, fraction); });
  }
  const std::vector<Figure> all = paper_figures(study);
  std::vector<Figure> figures;
  for (const Figure& figure : all) {
    const int number = std::stoi(figure.id.substr(3));
    const auto& only = arguments.only;
    if (only.empty() || std::find(only.begin(), only.end(), number) != only.end()) figures.push_back(figure);
  }
  const bool own_place = !arguments.output.empty();
  const fs::path output = own_place ? fs::path(arguments.output) : fs::path(arguments.folder) / "figures";
  write_figure_data(figures, output);
  print_verdicts(figures);
  fmt::print("{}", describe_absent(study));
  fmt::print("Figures: {}\n", output.string());
  // A run has a report of its own, which is not overwritten.
  const bool study_of_runs = study.points.size() > 1 || study.points.front().replicas.front().path != ".";
  if (own_place || study_of_runs) {
    const fs::path folder = own_place ? output : fs::path(arguments.folder);
    write_study_report(study, all, folder);
    fmt::print("Report: {}\n", (folder / "report.html").string());
  }
  std::fflush(stdout);
  draw_figures(figures, output, arguments.formats);
  return static_cast<int>(ExitCode::done);
}

}  // namespace sandglass
