// sandglass sweep: campaigns of many state points.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sandglass/cmd/commands.h"
#include "sandglass/cmd/interrupt.h"
#include "sandglass/cmd/progress_bar.h"
#include "sandglass/cmd/text.h"
#include "sandglass/core/errors.h"
#include "sandglass/io/config_table.h"
#include "sandglass/io/run_folder.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/study_page.h"
#include "sandglass/study/campaign.h"
#include "sandglass/study/campaign_run.h"
#include "sandglass/study/campaign_status.h"
#include "sandglass/study/collect.h"
#include "sandglass/study/cost.h"

namespace sandglass {
namespace {

struct Arguments {
  std::string study, folder;
  std::vector<std::string> assignments;
  double scale = 1;
  bool estimate = true, json = false;
  std::size_t jobs = 0;  // 0: one per core
};

std::string points_text(std::size_t count) { return fmt::format("{} point{}", count, count == 1 ? "" : "s"); }

/// Two digits, or all before the point.
std::string hours_text(double seconds) {
  const double hours = seconds / 3600;
  return hours < 100 ? fmt::format("{:.2g}", hours) : fmt::format("{:.0f}", hours);
}

/// "12 GB", for people.
std::string bytes_text(double bytes) {
  for (const char* unit : {"bytes", "kB", "MB", "GB"}) {
    if (bytes < 1000) return fmt::format("{:.3g} {}", bytes, unit);
    bytes /= 1000;
  }
  return fmt::format("{:.3g} TB", bytes);
}

/// What the configurations will cost here, after a probe of some seconds.
void print_estimate(const std::vector<Config>& configs) {
  Pace pace;
  {
    ProgressBar bar;
    pace = probe_pace(configs, [&](std::string_view stage, double fraction) { bar.show(stage, fraction); });
  }
  double seconds = 0, longest = 0, bytes = 0;
  for (const Config& config : configs) {
    seconds += pace.seconds(config);
    longest = std::max(longest, pace.seconds(config));
    bytes += expected_bytes(config);
  }
  const std::size_t cores = usable_cores();
  fmt::print("Expected: {} core-hours (+- {:.0f} %), the longest run {}, {} on disk; on the {} core{} here {}.\n",
             hours_text(seconds), 100 * pace_uncertainty(configs), duration_text(longest), bytes_text(bytes), cores,
             cores == 1 ? "" : "s", duration_text(std::max(longest, seconds / static_cast<double>(cores))));
}

int init(const Arguments& arguments) {
  const std::string text = read_config_file(arguments.study);
  const SweepPlan plan =
      read_study_text(text, arguments.study, std::filesystem::absolute(arguments.study).parent_path(),
                      arguments.assignments, arguments.scale);
  RunFolder lock = RunFolder::open(arguments.folder, FolderMode::resume);  // against another sweep init
  const CampaignChange change = plan_campaign(plan, lock.path());
  lock.begin();
  write_campaign(change, text);

  fmt::print("{}: {} new, {} there before\n", arguments.folder, points_text(change.added.size()), change.kept);
  if (plan.repeated > 0)
    fmt::print("Note: {} came up more than once in the study and is made once.\n", points_text(plan.repeated));
  if (!change.dropped.empty()) {
    fmt::print(
        "Note: {} of the campaign no longer in the study; what is there stays, and is run. To drop a point, "
        "remove its line in manifest.tsv:\n",
        points_text(change.dropped.size()));
    for (const std::string& path : change.dropped) fmt::print("  {}\n", path);
  }
  std::fflush(stdout);
  if (arguments.estimate && !change.added.empty()) print_estimate(change.added);
  fmt::print("Start it here: sandglass sweep run {}\nOn a cluster:  examples/slurm/array.sbatch, points 1 to {}\n",
             shell_word(arguments.folder), change.manifest.rows.empty() ? 0 : change.manifest.rows.back().index);
  return static_cast<int>(ExitCode::done);
}

std::filesystem::path campaign_manifest(const std::string& folder) {
  const std::filesystem::path file = manifest_in(folder);
  if (!std::filesystem::exists(file))
    throw InputError(fmt::format(
        "{} holds no campaign (there is no manifest.tsv): make one by sandglass sweep init STUDY.toml -o {}", folder,
        shell_word(folder)));
  return file;
}

int run(const Arguments& arguments) {
  const std::filesystem::path manifest = campaign_manifest(arguments.folder);
  catch_stop_signals();
  CampaignResult result;
  {
    ProgressBar bar;
    const bool terminal = ::isatty(STDERR_FILENO) != 0;
    result = run_campaign(
        manifest, arguments.jobs,
        {.progress =
             [&](const CampaignProgress& p) {
               std::string state = fmt::format("{} of {} done, {} running", p.done, p.points, p.running);
               if (p.elsewhere > 0) state += fmt::format(", {} in other processes", p.elsewhere);
               if (p.failed > 0) state += fmt::format(", {} failed", p.failed);
               bar.show(fmt::format("campaign ({})", state), p.fraction);
             },
         .message = [&](const std::string& text) { fmt::print(stderr, "{}{}\n", terminal ? "\r\033[K" : "", text); },
         .stop_requested = stop_signal_came});
  }
  fmt::print("{} of {} done", result.progress.done, points_text(result.progress.points));
  if (!result.failed.empty()) fmt::print(", {} failed", result.failed.size());
  fmt::print(".\n");
  for (const FailedPoint& point : result.failed)
    fmt::print("  failed: {} {}: {}\n", point.index, point.path, point.reason);
  if (result.stopped) {
    fmt::print("Stopped. Go on with: sandglass sweep run {}\n", shell_word(arguments.folder));
    return static_cast<int>(ExitCode::resumable);
  }
  return static_cast<int>(result.failed.empty() ? ExitCode::done : ExitCode::failure);
}

struct Line {
  const ManifestRow* row;
  PointStatus status;
  double cost;  // by the table; 0 where its configuration cannot be read
};

/// Sums over the points, by state and by expected cost.
struct Totals {
  std::array<std::size_t, 5> count{};
  double fraction = 0;      ///< of all the work
  double seconds_left = 0;  ///< on one core: at the pace of the finished runs, or the table's
};

Totals totals_of(const std::vector<Line>& lines) {
  Totals totals;
  double all = 0, worked = 0, finished_cost = 0, finished_seconds = 0;
  for (const Line& line : lines) {
    ++totals.count[static_cast<std::size_t>(line.status.state)];
    all += line.cost;
    worked += line.cost * line.status.fraction;
    if (!line.status.wall_seconds) continue;
    finished_cost += line.cost;
    finished_seconds += *line.status.wall_seconds;
  }
  totals.fraction = all > 0 ? worked / all : 0;
  totals.seconds_left = (all - worked) * (finished_cost > 0 ? finished_seconds / finished_cost : 1);
  return totals;
}

nlohmann::ordered_json status_json(const std::vector<Line>& lines) {
  using Json = nlohmann::ordered_json;
  const auto value_or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json points = Json::array();
  for (const auto& [row, status, cost] : lines)
    points.push_back({{"index", row->index},
                      {"path", row->path},
                      {"state", name_of(status.state)},
                      {"fraction", status.fraction},
                      {"stage", status.stage},
                      {"remark", status.remark},
                      {"collisions_per_second", value_or_null(status.collisions_per_second)},
                      {"wall_seconds", value_or_null(status.wall_seconds)},
                      {"seconds_left", value_or_null(status.seconds_left)}});
  const Totals totals = totals_of(lines);
  Json counts = Json::object();
  for (std::size_t state = 0; state < totals.count.size(); ++state)
    counts[std::string(name_of(static_cast<PointState>(state)))] = totals.count[state];
  return {{"points", points},
          {"totals",
           {{"points", lines.size()},
            {"states", counts},
            {"fraction", totals.fraction},
            {"core_seconds_left", totals.seconds_left}}}};
}

std::string remark_text(const PointStatus& status) {
  if (status.state == PointState::done && status.collisions_per_second)
    return fmt::format("{:.2f} million collisions/s, {}", *status.collisions_per_second / 1e6,
                       duration_text(status.wall_seconds.value_or(0)));
  if (status.state == PointState::running && !status.stage.empty())
    return status.stage + (status.remark.empty() ? "" : ", " + status.remark) +
           (status.seconds_left ? ", " + duration_text(*status.seconds_left) + " left" : "");
  return status.state == PointState::not_started ? "" : status.remark;
}

void print_status(const std::vector<Line>& lines) {
  std::size_t width = 4;
  for (const Line& line : lines) width = std::max(width, line.row->path.size());
  fmt::print("{:>6}  {:<11}  {:>5}  {:<{}}\n", "index", "state", "", "path", width);
  for (const auto& [row, status, cost] : lines)
    fmt::print("{:>6}  {:<11}  {:>3.0f} %  {:<{}}  {}\n", row->index, name_of(status.state), 100 * status.fraction,
               row->path, width, remark_text(status));
  const Totals totals = totals_of(lines);
  std::string counts;
  for (std::size_t state = 0; state < totals.count.size(); ++state)
    if (totals.count[state] > 0)
      counts += fmt::format(", {} {}", totals.count[state], name_of(static_cast<PointState>(state)));
  fmt::print("{}{}: {:.0f} % of the work", points_text(lines.size()), counts, 100 * totals.fraction);
  fmt::print("{}\n",
             totals.seconds_left > 0 ? fmt::format(", about {} core-hours left", hours_text(totals.seconds_left)) : "");
}

int status(const Arguments& arguments) {
  const Manifest manifest = read_manifest(campaign_manifest(arguments.folder));
  std::vector<Line> lines;
  for (const ManifestRow& row : manifest.rows) {
    Line line{&row, status_of(manifest.run_folder(row)), 0};
    try {
      line.cost = reference_seconds(read_point(manifest, row));
    } catch (const InputError& error) {
      line.status.state = PointState::failed;
      line.status.remark = error.what();
    }
    lines.push_back(std::move(line));
  }
  if (arguments.json)
    fmt::print("{}\n", status_json(lines).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    print_status(lines);
  return static_cast<int>(ExitCode::done);
}

int collect(const Arguments& arguments) {
  Study study;
  {
    ProgressBar bar;
    study =
        collect_study(arguments.folder, [&](std::string_view stage, double fraction) { bar.show(stage, fraction); });
  }
  write_study_report(study, paper_figures(study), arguments.folder);
  std::size_t runs = 0;
  for (const StatePoint& point : study.points) runs += point.replicas.size();
  fmt::print("{} runs of {} state points collected\n", runs, study.points.size());
  fmt::print("{}", describe_absent(study));
  const std::filesystem::path folder = arguments.folder;
  fmt::print("Data: {}, {}\nReport: {}\n", (folder / "study.h5").string(), (folder / "csv").string(),
             (folder / "report.html").string());
  return static_cast<int>(ExitCode::done);
}

}  // namespace

int sweep_command(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"Campaigns: many state points from one file, here or on a cluster.", "sandglass sweep"};
  app.require_subcommand(1);
  const auto folder = [&](CLI::App* command) {
    command->add_option("folder", arguments.folder, "folder of the campaign")->required();
  };

  auto* init_app = app.add_subcommand("init", "make the folders of all points; again: add those that are new");
  init_app->add_option("study", arguments.study, "a configuration with a table [sweep]")->required();
  init_app->add_option("-o,--output", arguments.folder, "folder of the campaign")->required();
  init_app->add_option("--scale", arguments.scale, "multiply run.collisions of every point");
  init_app->add_option("--set", arguments.assignments, "set a key of every point, as in --set run.seed=7; repeatable")
      ->expected(1)
      ->take_all();
  init_app->add_flag("!--no-estimate", arguments.estimate, "do not probe what it will cost");

  auto* run_app = app.add_subcommand("run", "run all points that are not finished on this machine");
  folder(run_app);
  run_app->add_option("-j,--jobs", arguments.jobs, "runs at a time (default: one per core)")
      ->check(CLI::PositiveNumber);

  auto* status_app = app.add_subcommand("status", "how far it is; changes nothing");
  folder(status_app);
  status_app->add_flag("--json", arguments.json, "print one JSON object instead of a table");

  auto* collect_app =
      app.add_subcommand("collect", "merge the replicas of all finished points: study.h5, CSV, and a report");
  folder(collect_app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::bad_input);
  }
  if (init_app->parsed()) return init(arguments);
  if (collect_app->parsed()) return collect(arguments);
  return run_app->parsed() ? run(arguments) : status(arguments);
}

}  // namespace sandglass
