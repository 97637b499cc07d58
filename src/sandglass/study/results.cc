#include "sandglass/study/results.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "sandglass/io/apart.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"

namespace sandglass {
namespace {

std::vector<Quantity> make_quantities() {
  std::vector<Quantity> list;
  auto of_lag = [&](const std::string& group) {
    list.push_back({.group = group, .axes = {"time"}, .companion = "collisions"});
  };
  auto of_interval = [&](const std::string& group, std::vector<std::string> axes) {
    list.push_back(
        {.group = group, .axes = std::move(axes), .value = "interval_value", .error = "interval_error", .count = ""});
  };
  for (const std::string species : {"all", "small", "big"}) {
    const std::string dynamics = "/dynamics/" + species + "/";
    for (const char* name :
         {"mean_square_displacement", "cage_relative_displacement", "velocity_autocorrelation", "diffusion_coefficient",
          "running_diffusion", "non_gaussian", "overlap", "susceptibility", "mobility/fastest", "mobility/slowest"})
      of_lag(dynamics + name);
    list.push_back({.group = dynamics + "velocity_autocorrelation",
                    .axes = {},
                    .value = "equal_time_value",
                    .error = "equal_time_error",
                    .count = ""});
    for (const char* name : {"self_intermediate_scattering", "gaussian_approximation"})
      list.push_back({.group = dynamics + name, .axes = {"wavenumber", "time"}, .companion = "collisions"});
    list.push_back({.group = dynamics + "van_hove", .axes = {"time", "r"}});
    of_interval(dynamics + "mean_square_displacement", {"interval", "time"});
    of_interval(dynamics + "self_intermediate_scattering", {"interval", "wavenumber", "time"});
    list.push_back({.group = "/timeseries",
                    .axes = {"time"},
                    .value = "temperature_" + species,
                    .error = "temperature_" + species + "_error",
                    .count = "",
                    .companion = "collisions"});
  }
  for (const std::string pair : {"all", "small_small", "small_big", "big_big"}) {
    list.push_back({.group = "/structure/radial_distribution",
                    .axes = {"r"},
                    .value = pair,
                    .error = pair + "_error",
                    .count = ""});
    list.push_back({.group = "/structure/contact", .axes = {}, .value = pair, .error = pair + "_error", .count = ""});
  }
  for (const std::string species : {"all", "small"}) {
    const std::string group = "/structure/structure_factor/" + species;
    list.push_back({.group = group, .axes = {}, .value = "spacing", .error = "", .count = ""});
    list.push_back({.group = group + "/ring", .axes = {"wavenumber"}});
    list.push_back({.group = group + "/ring",
                    .axes = {"wavenumber"},
                    .value = "anisotropy",
                    .error = "anisotropy_error",
                    .count = "count"});
  }
  for (const std::string name : {"global", "local"})
    list.push_back(
        {.group = "/structure/bond_order", .axes = {}, .value = name, .error = name + "_error", .count = ""});
  list.push_back({.group = "/dynamics", .axes = {"interval"}, .value = "waiting_time", .error = "", .count = ""});
  list.push_back({.group = "/structure/bond_order/correlation", .axes = {"r"}});
  for (const char* name : {"transverse", "longitudinal"})
    list.push_back({.group = std::string("/structure/velocity/") + name, .axes = {"wavenumber"}});
  return list;
}

/// The argument of what is kept apart by intervals is not in the file: their number, counted from 0.
void number_intervals(const Quantity& q, std::vector<Dataset>& results) {
  const Dataset* values = find_dataset(results, q.path(q.value));
  if (values == nullptr || values->shape.empty() || find_dataset(results, q.path("interval")) != nullptr) return;
  std::vector<double> numbers(values->shape.front());
  std::iota(numbers.begin(), numbers.end(), 0.0);
  results.push_back({q.path("interval"), {numbers.size()}, std::move(numbers), ""});
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> list = make_quantities();
  return list;
}

namespace {

std::vector<Dataset> read_datasets(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  std::vector<Dataset> results;
  std::set<std::string> seen;
  auto read = [&](const std::string& object) {
    if (!seen.insert(object).second || !file.has(object)) return;
    const Shape shape = file.shape(object);
    const std::string unit = file.text_attribute(object, "unit");
    if (object.ends_with("/count"))
      results.push_back({object, shape, file.read<std::uint64_t>(object, shape), unit});
    else
      results.push_back({object, shape, file.read<double>(object, shape), unit});
  };
  for (const Quantity& q : quantities()) {
    for (const std::string& axis : q.axes) read(q.path(axis));
    for (const std::string& part : {q.companion, q.value, q.error, q.count})
      if (!part.empty()) read(q.path(part));
    if (!q.axes.empty() && q.axes.front() == "interval") number_intervals(q, results);
  }
  for (const char* species : {"all", "small"})  // a map has no arguments of its own: index times spacing
    read("/structure/structure_factor/" + std::string(species) + "/map");
  return results;
}

}  // namespace

std::vector<Dataset> read_results(const std::filesystem::path& path) {
  if (has_seal(path))
    check_seal(path);
  else  // of an older version, or touched by another program
    try_apart(path, [&] { read_datasets(path); });
  return read_datasets(path);
}

const Dataset* find_dataset(const std::vector<Dataset>& results, const std::string& path) {
  const auto found = std::find_if(results.begin(), results.end(), [&](const Dataset& d) { return d.path == path; });
  return found == results.end() ? nullptr : &*found;
}

std::vector<double> numbers_of(const std::vector<Dataset>& results, const std::string& path) {
  const Dataset* dataset = find_dataset(results, path);
  if (dataset == nullptr) return {};
  return std::visit([](const auto& values) { return std::vector<double>(values.begin(), values.end()); },
                    dataset->values);
}

}  // namespace sandglass
