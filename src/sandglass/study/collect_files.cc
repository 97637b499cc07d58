// What collecting writes: study.h5 and one CSV file for each quantity.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "sandglass/core/errors.h"
#include "sandglass/core/version.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/config_table.h"
#include "sandglass/io/csv.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/study/collect.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

namespace fs = std::filesystem;

/// The first columns of every file: which point a row is about.
struct PointColumns {
  explicit PointColumns(const Study& study) {
    header = "point,packing_fraction,restitution,particles";
    for (const Key& key : config_table())
      for (const std::string& axis : study.axes)
        if (axis == key.name) keys.push_back(&key), header.append(",").append(axis);
  }
  [[nodiscard]] std::string row(const StatePoint& point) const {
    std::string text = fmt::format("{},{},{},{}", point.name, point.packing_fraction(), point.restitution(),
                                   point.config.system.particles);
    for (const Key* key : keys) text.append(",").append(csv_cell(key->write(point.config, *key)));
    return text;
  }
  std::string header;
  std::vector<const Key*> keys;
};

/// What was measured: all numbers but those that say which point it is.
std::set<std::string> number_names(const Study& study) {
  std::set<std::string> names;
  for (const StatePoint& point : study.points)
    for (const auto& [name, number] : point.numbers) names.insert(name);
  for (const char* name : {"packing_fraction", "restitution"}) names.erase(name);
  return names;
}

std::string points_csv(const Study& study, const PointColumns& columns) {
  const auto names = number_names(study);
  std::string csv = "# One row a state point, replicas merged; X_error is the standard error of X.\n" + columns.header +
                    ",replicas,collisions_per_disk_in_all";
  for (const std::string& name : names) csv += fmt::format(",{0},{0}_error", name);
  csv += '\n';
  for (const StatePoint& point : study.points) {
    csv += fmt::format("{},{},{}", columns.row(point), point.replicas.size(), point.length());
    for (const std::string& name : names) {
      const Measured number = point.number(name);
      csv += fmt::format(",{},{}", csv_cell(number.value), csv_cell(number.error));
    }
    csv += '\n';
  }
  return csv;
}

std::string runs_csv(const Study& study) {
  std::string csv = "# Every run that was found or expected.\npath,point,seed,collisions_per_disk,stationary,remark\n";
  for (const StatePoint& point : study.points)
    for (const Replica& r : point.replicas)
      csv += fmt::format("{},{},{},{},{},\n", csv_cell(r.path), point.name, r.summary.seed,
                         r.summary.collisions_per_particle, r.summary.stationary ? "yes" : "no");
  for (const AbsentRun& run : study.absent) csv += fmt::format("{},,,,,{}\n", csv_cell(run.path), csv_cell(run.why));
  return csv;
}

/// The rows of one quantity: one a point and argument.
void append_rows(std::string& csv, const StatePoint& point, const std::string& first, const Quantity& q,
                 const std::string& group) {
  const Dataset* dataset = find_dataset(point.results, q.path(q.value));
  if (dataset == nullptr) return;
  const auto value = numbers_of(point.results, q.path(q.value)), error = numbers_of(point.results, q.path(q.error));
  const auto count = numbers_of(point.results, q.path(q.count));
  const auto companion = q.companion.empty() ? std::vector<double>{} : numbers_of(point.results, q.path(q.companion));
  std::vector<std::vector<double>> axes;
  for (const std::string& axis : q.axes) axes.push_back(numbers_of(point.results, q.path(axis)));
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!std::isfinite(value[i])) continue;
    std::string arguments;
    std::size_t stride = value.size(), rest = i;
    for (const auto& axis : axes) {
      stride /= axis.size();
      arguments.append(",").append(csv_cell(axis[rest / stride]));
      rest %= stride;
    }
    if (!q.companion.empty())
      arguments.append(",").append(companion.empty() ? "" : csv_cell(companion[i % companion.size()]));
    csv += fmt::format("{},{}{},{},{},{}\n", first, group, arguments, csv_cell(value[i]),
                       error.empty() ? "" : csv_cell(error[i]), count.empty() ? "" : csv_cell(count[i]));
  }
}

/// Quantities of all species share a file: "/dynamics/small/overlap" is "small" in overlap.csv.
struct CsvPlace {
  std::string file, group;
};

CsvPlace csv_place(const Quantity& q) {
  std::vector<std::string> steps{""};
  for (const char c : q.group.substr(1) + "/" + q.value) {
    if (c == '/')
      steps.emplace_back();
    else
      steps.back() += c;
  }
  std::string file, group;
  if (steps[0] == "timeseries") return {"temperature", steps[1].substr(steps[1].rfind('_') + 1)};
  for (const std::string& step : steps) {
    if (step == "dynamics" || step == "structure" || step == "value") continue;
    const bool is_group = step == "all" || step == "small" || step == "big" || step.starts_with("small_") ||
                          step == "big_big" || step == "fastest" || step == "slowest" || step == "transverse" ||
                          step == "longitudinal";
    std::string& text = is_group ? group : file;
    text.append(text.empty() ? "" : "_").append(step);
  }
  return {file, group};
}

void write_csv(const Study& study, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  const PointColumns columns(study);
  write_whole(folder / "points.csv", points_csv(study, columns));
  write_whole(folder / "runs.csv", runs_csv(study));
  std::map<std::string, std::string> files;
  for (const Quantity& q : quantities()) {
    const CsvPlace place = csv_place(q);
    std::string rows;
    for (const StatePoint& point : study.points) append_rows(rows, point, columns.row(point), q, place.group);
    if (rows.empty()) continue;
    std::string& csv = files[place.file];
    if (csv.empty()) {
      csv = fmt::format("# {} of each state point, replicas merged; error is the standard error.\n{},group", place.file,
                        columns.header);
      for (const std::string& axis : q.axes) csv.append(",").append(axis);
      if (!q.companion.empty()) csv.append(",").append(q.companion);
      csv += ",value,error,count\n";
    }
    csv += rows;
  }
  for (const auto& [name, csv] : files) write_whole(folder / (name + ".csv"), csv);
}

void write_hdf5(const Study& study, const fs::path& path) {
  replace_file(path, [&](const fs::path& temporary) {
    Hdf5File file = Hdf5File::create(temporary);
    file.write_text("/version", std::string(version));
    auto column = [&](const std::string& name, auto&& of_point) {
      std::vector<double> values;
      for (const StatePoint& point : study.points) values.push_back(of_point(point));
      file.write<double>("/table/" + name, {values.size()}, values);
    };
    std::string names;
    for (const StatePoint& point : study.points) names += point.name + '\n';
    file.write_text("/table/points", names);
    column("packing_fraction", [](const StatePoint& p) { return p.packing_fraction(); });
    column("restitution", [](const StatePoint& p) { return p.restitution(); });
    column("particles", [](const StatePoint& p) { return static_cast<double>(p.config.system.particles); });
    column("replicas", [](const StatePoint& p) { return static_cast<double>(p.replicas.size()); });
    for (const std::string& name : number_names(study)) {
      column(name + "/value", [&](const StatePoint& p) { return p.number(name).value; });
      column(name + "/error", [&](const StatePoint& p) { return p.number(name).error; });
    }
    for (const StatePoint& point : study.points) {
      const std::string group = "/points/" + point.name;
      file.write_text(group + "/config", config_to_toml(point.config));
      std::string runs;
      for (const Replica& replica : point.replicas) runs += replica.path + '\n';
      file.write_text(group + "/runs", runs);
      for (const Dataset& dataset : point.results) {
        std::visit([&](const auto& values) { file.write(group + dataset.path, dataset.shape, std::span(values)); },
                   dataset.values);
        file.set_attribute(group + dataset.path, "unit", dataset.unit);
      }
    }
    file.close();
  });
}

}  // namespace

void write_study(const Study& study, const fs::path& folder) {
  write_hdf5(study, folder / "study.h5");
  write_csv(study, folder / "csv");
}

}  // namespace sandglass
