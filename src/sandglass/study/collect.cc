#include "sandglass/study/collect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/config_table.h"
#include "sandglass/study/manifest.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t longest_text = 1 << 24;
constexpr const char* not_started = "not started";

/// Folders with a config.toml, by path. Links are not followed: what is linked into a study may lead anywhere.
std::vector<fs::path> run_folders(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError(fmt::format("{} is no folder: give the folder of a run or of a study", folder.string()));
  std::vector<fs::path> found;
  if (fs::exists(folder / "config.toml", error)) found.push_back(folder);
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    std::error_code unreadable;
    if (entry->is_directory(unreadable) && !entry->is_symlink(unreadable) &&
        fs::exists(entry->path() / "config.toml", unreadable))
      found.push_back(entry->path());
  }
  if (error) throw InputError(fmt::format("{} cannot be read: {}", folder.string(), error.message()));
  std::sort(found.begin(), found.end());
  return found;
}

std::string relative_name(const fs::path& path, const fs::path& folder) {
  return path.lexically_relative(folder).generic_string();
}

/// The configuration of a finished run. Its start file may be gone since (a study that was moved): that is no reason
/// to refuse its results.
Config read_old_config(const fs::path& folder) {
  const std::string text = read_whole(folder / "config.toml", longest_text);
  const std::string name = (folder / "config.toml").string();
  try {
    return read_config_text(text, name, folder);
  } catch (const InputError&) {
    Config config;
    try {
      config = read_config_text(text, name, folder, {"prepare.method=quench", "prepare.file=\"\""});
    } catch (const InputError&) {
      return read_config_text(text, name, folder);  // the first message is the right one
    }
    config.prepare.method = PrepareMethod::file;
    return config;
  }
}

/// Text that may stand in names of points and of columns.
std::string safe_word(std::string text) {
  std::erase(text, '"');
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_' && c != '=') c = '-';
  return text;
}

/// Numbers of a summary that are averages, with their places; counts and speeds are of a run, not of a state point.
void flatten(const Json& json, const std::string& at, std::map<std::string, double>& numbers) {
  static const std::set<std::string> of_the_run{"seed",        "collisions", "kicks",        "kicks_without_partner",
                                                "calibration", "momentum",   "wall_seconds", "collisions_per_second",
                                                "errors",      "particles"};
  for (const auto& [name, value] : json.items()) {
    const std::string place = at.empty() ? name : at + "/" + name;
    if (of_the_run.contains(place) || place.size() > 100 || safe_word(name) != name || name.empty()) continue;
    if (value.is_object()) flatten(value, place, numbers);
    if (value.is_number()) numbers[place] = value.get<double>();
  }
}

/// The standard error that belongs to the number at `place`: under /errors, or beside it.
double error_at(const Json& summary, const std::map<std::string, double>& numbers, const std::string& place) {
  std::string flat = place;
  std::replace(flat.begin(), flat.end(), '/', '_');
  if (summary.contains("errors") && summary["errors"].contains(flat) && summary["errors"][flat].is_number())
    return summary["errors"][flat].get<double>();
  const std::size_t slash = place.rfind('/');
  const std::string parent = slash == place.npos ? "" : place.substr(0, slash + 1);
  std::string leaf = place.substr(parent.size());
  if (leaf.starts_with("from_")) leaf = leaf.substr(5);
  std::vector<std::string> beside{place + "_error", parent + leaf + "_error"};
  if (leaf == "value" || leaf == "small" || leaf == "msd") beside.push_back(parent + "error");
  for (const std::string& name : beside)
    if (const auto found = numbers.find(name); found != numbers.end()) return found->second;
  return Summary::unknown;
}

struct Run {
  Replica replica;
  Config config;
  std::map<std::string, Measured> numbers;
  RunResults results;
};

Run read_run(const fs::path& folder, const fs::path& study) {
  Run run{{relative_name(folder, study), read_summary(folder / "summary.json")}, read_old_config(folder), {}, {}};
  run.results = {read_results(folder / "observables.h5"), run.replica.summary.collisions_per_particle};
  if (!(run.results.length > 0)) throw InputError("the summary does not say how long the run measured");
  const Json summary = Json::parse(read_whole(folder / "summary.json", longest_text));
  std::map<std::string, double> numbers;
  flatten(summary, "", numbers);
  for (const auto& [place, value] : numbers) run.numbers[place] = {value, error_at(summary, numbers, place)};
  return run;
}

/// What tells state points apart: every physics key but seed and start file.
std::string identity(const Config& config) {
  std::string text;
  for (const Key& key : config_table())
    if (key.physics && key.name != "run.seed" && key.name != "prepare.file")
      text += fmt::format("{}={}\n", key.name, key.write(config, key));
  return text;
}

/// Keys beyond packing fraction, restitution and size in which the points differ.
std::vector<std::string> differing_axes(const std::vector<StatePoint>& points) {
  std::set<std::string> axes;
  for (const StatePoint& point : points)
    for (const std::string& key : differing_keys(points.front().config, point.config)) axes.insert(key);
  for (const char* known :
       {"run.seed", "prepare.file", "system.packing_fraction", "collision.restitution", "system.particles"})
    axes.erase(known);
  return {axes.begin(), axes.end()};
}

void name_points(Study& study) {
  std::set<std::string> taken;
  for (StatePoint& point : study.points) {
    const Config& c = point.config;
    std::string name =
        fmt::format("eta={:g}_eps={:g}_N={}", c.system.packing_fraction, c.collision.restitution, c.system.particles);
    for (const Key& key : config_table())
      if (std::find(study.axes.begin(), study.axes.end(), key.name) != study.axes.end())
        name += fmt::format("_{}={}", key.leaf(), safe_word(key.write(c, key)));
    point.name = name.substr(0, 200);
    for (int twin = 2; !taken.insert(point.name).second; ++twin)
      point.name = fmt::format("{}_{}", name.substr(0, 200), twin);
  }
}

StatePoint merge_runs(std::vector<Run>& runs) {
  StatePoint point{{}, runs.front().config, {}, {}, {}};
  std::vector<RunResults> results;
  std::map<std::string, std::vector<Sample>> samples;
  for (Run& run : runs) {
    for (const auto& [place, number] : run.numbers)
      samples[place].push_back({number.value, number.error, run.results.length});
    point.replicas.push_back(std::move(run.replica));
    results.push_back(std::move(run.results));
  }
  point.results = merge_results(results);
  for (const auto& [place, list] : samples) point.numbers[place] = merge(list);
  return point;
}

/// The runs that the manifest expects: paths relative to the study.
std::vector<std::string> expected_runs(const fs::path& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  if (!fs::exists(manifest_in(folder), error)) return paths;
  for (const ManifestRow& row : read_manifest(manifest_in(folder)).rows)
    paths.push_back(fs::path(row.path).lexically_normal().generic_string());
  return paths;
}

}  // namespace

double StatePoint::length() const {
  double sum = 0;
  for (const Replica& replica : replicas) sum += replica.summary.collisions_per_particle;
  return sum;
}

Measured StatePoint::number(const std::string& path) const {
  const auto found = numbers.find(path);
  return found == numbers.end() ? Measured{} : found->second;
}

Study read_study(const fs::path& folder, const Progress& progress) {
  Study study{folder, {}, {}, {}};
  std::map<std::string, std::vector<fs::path>> groups;  // only folders: the results of a large study are many
  std::set<std::string> seen;
  auto absent = [&](const fs::path& path, std::string why) {
    study.absent.push_back({relative_name(path, folder), std::move(why)});
  };
  for (const fs::path& path : run_folders(folder)) {
    seen.insert(relative_name(path, folder));
    std::error_code error;
    if (!fs::exists(path / "summary.json", error)) {
      const bool begun = fs::exists(path / "run.log", error) || fs::exists(path / "checkpoint.h5", error);
      absent(path, begun ? "not finished: run --resume goes on" : not_started);
      continue;
    }
    try {
      groups[identity(read_old_config(path))].push_back(path);
    } catch (const InputError& e) {
      absent(path, e.what());
    }
  }
  for (const std::string& path : expected_runs(folder))
    if (seen.insert(path).second) study.absent.push_back({path, not_started});

  double done = 0;
  for (const auto& [key, paths] : groups) {
    report_progress(progress, "reading", done++ / static_cast<double>(groups.size()));
    std::vector<Run> runs;
    for (const fs::path& path : paths) {
      try {
        runs.push_back(read_run(path, folder));
      } catch (const InputError& e) {
        absent(path, e.what());
      }
    }
    if (!runs.empty()) study.points.push_back(merge_runs(runs));
  }
  std::sort(study.absent.begin(), study.absent.end(),
            [](const AbsentRun& a, const AbsentRun& b) { return a.path < b.path; });
  if (study.points.empty()) {
    if (study.absent.empty())
      throw InputError(
          fmt::format("there is no run under {}: a run is a folder with config.toml, summary.json and observables.h5",
                      folder.string()));
    const auto told = std::find_if(study.absent.begin(), study.absent.end(),
                                   [](const AbsentRun& run) { return run.why != std::string_view(not_started); });
    const AbsentRun& run = told == study.absent.end() ? study.absent.front() : *told;
    throw InputError(fmt::format("no run under {} is finished and readable; for example {}: {}", folder.string(),
                                 run.path, run.why));
  }
  study.axes = differing_axes(study.points);
  name_points(study);
  std::sort(study.points.begin(), study.points.end(), [](const StatePoint& a, const StatePoint& b) {
    return std::tuple(a.packing_fraction(), a.restitution(), a.name) <
           std::tuple(b.packing_fraction(), b.restitution(), b.name);
  });
  return study;
}

std::string describe_absent(const Study& study) {
  constexpr std::size_t most = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, study.absent.size()); ++i)
    text += fmt::format("Note: no data of {}: {}\n", study.absent[i].path, study.absent[i].why);
  if (study.absent.size() > most)
    text += fmt::format("Note: nor of {} more runs, which report.html names\n", study.absent.size() - most);
  return text;
}

Study collect_study(const fs::path& folder, const Progress& progress) {
  Study study = read_study(folder, progress);
  report_progress(progress, "writing", 1);
  write_study(study, folder);
  return study;
}

}  // namespace sandglass
