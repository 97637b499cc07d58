// manifest.tsv: the list of the points of a campaign, by which any scheduler finds its work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/io/config.h"

namespace sandglass {

/// One line: a point, its folder, and what tells it from the others.
struct ManifestRow {
  std::uint64_t index = 0;          ///< from 1; stays with the point when others are added
  std::string path;                 ///< of the run's folder, relative to that of the manifest
  std::uint64_t seed = 0;           ///< run.seed
  std::vector<std::string> values;  ///< of the axes, as config.toml has them
};

/// Tab-separated text with one header line: index, path, seed, then the keys that are the axes of the sweep. Rows may
/// stand in any order.
struct Manifest {
  std::filesystem::path folder;
  std::vector<std::string> axes;
  std::vector<ManifestRow> rows;

  [[nodiscard]] std::filesystem::path run_folder(const ManifestRow& row) const { return folder / row.path; }
};

/// The manifest of a campaign's folder.
std::filesystem::path manifest_in(const std::filesystem::path& folder);

/// Throws InputError naming file, line and reason: a number that is none, an index or path given twice, a path that
/// leaves the folder, an axis that is no key.
Manifest read_manifest(const std::filesystem::path& file);

/// Whole or not at all.
void write_manifest(const std::filesystem::path& file, const Manifest& manifest);

/// The row with this index. Throws InputError that names the indices there are.
const ManifestRow& find_row(const Manifest& manifest, std::uint64_t index);

/// The configuration in the folder of a row. Throws InputError where there is none or it is not what the row says.
Config read_point(const Manifest& manifest, const ManifestRow& row);

}  // namespace sandglass
