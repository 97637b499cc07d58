#include "sandglass/study/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <unordered_set>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/config_table.h"
#include "sandglass/study/sweep_plan.h"

namespace sandglass {
namespace {

constexpr std::size_t longest_file = std::size_t{1} << 25;
constexpr std::size_t fixed_columns = 3;  // index, path, seed

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t start = 0;;) {
    const std::size_t end = text.find(separator, start);
    parts.emplace_back(text.substr(start, end - start));
    if (end == text.npos) return parts;
    start = end + 1;
  }
}

std::uint64_t whole_number(const std::string& text, const char* column, const std::string& place) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    throw InputError(fmt::format("{}: {} must be a whole number, not {}", place, column, toml_quote(text)));
  return value;
}

/// A path below the folder of the manifest: whatever stands in the file, runs write nowhere else.
std::string checked_path(const std::string& text, const std::string& place) {
  const std::filesystem::path path(text);
  const bool inside = !text.empty() && path.is_relative() && text.find('\0') == text.npos &&
                      std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; }) &&
                      path.lexically_normal() != ".";
  if (!inside)
    throw InputError(fmt::format("{}: path {} must lead to a folder below that of the manifest, such as runs/a", place,
                                 toml_quote(text)));
  return text;
}

std::vector<std::string> read_header(const std::string& line, const std::string& place) {
  std::vector<std::string> columns = split(line, '\t');
  const bool known =
      columns.size() >= fixed_columns && columns[0] == "index" && columns[1] == "path" && columns[2] == "seed";
  if (!known)
    throw InputError(fmt::format(
        "{}: this is no manifest: the first line must name the columns index, path, seed and then the axes, "
        "separated by tabs",
        place));
  columns.erase(columns.begin(), columns.begin() + fixed_columns);
  for (const std::string& axis : columns) find_key(axis, place);
  return columns;
}

ManifestRow read_row(const std::string& line, std::size_t axes, const std::string& place) {
  std::vector<std::string> columns = split(line, '\t');
  if (columns.size() != fixed_columns + axes)
    throw InputError(fmt::format("{}: there are {} columns instead of {}: the header names one more or less", place,
                                 columns.size(), fixed_columns + axes));
  ManifestRow row{.index = whole_number(columns[0], "index", place),
                  .path = checked_path(columns[1], place),
                  .seed = whole_number(columns[2], "seed", place),
                  .values = {columns.begin() + fixed_columns, columns.end()}};
  if (row.index == 0) throw InputError(fmt::format("{}: an index is at least 1", place));
  return row;
}

}  // namespace

std::filesystem::path manifest_in(const std::filesystem::path& folder) { return folder / "manifest.tsv"; }

Manifest read_manifest(const std::filesystem::path& file) {
  Manifest manifest{.folder = file.has_parent_path() ? file.parent_path() : ".", .axes = {}, .rows = {}};
  const std::vector<std::string> lines = split(read_whole(file, longest_file), '\n');
  std::unordered_set<std::uint64_t> indices;
  std::unordered_set<std::string> paths;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string line = lines[i];
    if (line.ends_with('\r')) line.pop_back();  // an editor's
    const std::string place = fmt::format("{}:{}", file.string(), i + 1);
    if (i == 0) {
      manifest.axes = read_header(line, place);
    } else if (!line.empty()) {
      manifest.rows.push_back(read_row(line, manifest.axes.size(), place));
      if (!indices.insert(manifest.rows.back().index).second)
        throw InputError(fmt::format("{}: index {} is given twice", place, manifest.rows.back().index));
      if (!paths.insert(std::filesystem::path(manifest.rows.back().path).lexically_normal().string()).second)
        throw InputError(fmt::format("{}: path {} is given twice", place, manifest.rows.back().path));
    }
  }
  return manifest;
}

void write_manifest(const std::filesystem::path& file, const Manifest& manifest) {
  std::string text = "index\tpath\tseed";
  for (const std::string& axis : manifest.axes) text += '\t' + axis;
  text += '\n';
  for (const ManifestRow& row : manifest.rows) {
    text += fmt::format("{}\t{}\t{}", row.index, row.path, row.seed);
    for (const std::string& value : row.values) text += '\t' + value;
    text += '\n';
  }
  write_whole(file, text);
}

const ManifestRow& find_row(const Manifest& manifest, std::uint64_t index) {
  const auto row = std::find_if(manifest.rows.begin(), manifest.rows.end(),
                                [&](const ManifestRow& candidate) { return candidate.index == index; });
  if (row != manifest.rows.end()) return *row;
  std::uint64_t least = 0, most = 0;
  for (const ManifestRow& candidate : manifest.rows) {
    least = least == 0 ? candidate.index : std::min(least, candidate.index);
    most = std::max(most, candidate.index);
  }
  throw InputError(fmt::format(
      "the manifest in {} has no point {}: {}", manifest.folder.string(), index,
      manifest.rows.empty() ? "it has none at all" : fmt::format("its indices go from {} to {}", least, most)));
}

Config read_point(const Manifest& manifest, const ManifestRow& row) {
  const std::filesystem::path file = manifest.run_folder(row) / "config.toml";
  Config config = read_config(file);
  const auto require = [&](const std::string& key, const std::string& said) {
    if (value_text(config, key) != said)
      throw InputError(
          fmt::format("{} has {} = {}, but point {} of the manifest says {}: put the manifest right, or make "
                      "it anew by sandglass sweep init",
                      file.string(), key, value_text(config, key), row.index, said));
  };
  require("run.seed", fmt::format("{}", row.seed));
  for (std::size_t i = 0; i < manifest.axes.size(); ++i) require(manifest.axes[i], row.values[i]);
  return config;
}

}  // namespace sandglass
