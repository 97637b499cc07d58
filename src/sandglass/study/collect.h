// A campaign read back: the finished runs under a folder, grouped into state points, replicas merged.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sandglass/core/progress.h"
#include "sandglass/io/config.h"
#include "sandglass/io/summary.h"
#include "sandglass/study/merge.h"

namespace sandglass {

/// One finished run of a state point.
struct Replica {
  std::string path;  ///< of its folder, relative to the study's; "." for the study's folder itself
  Summary summary;
};

/// Runs that differ in nothing but the seed and the start file.
struct StatePoint {
  std::string name;  ///< of letters, digits and "=._-", unique in the study, such as "eta=0.8_eps=0.9_N=10000"
  Config config;     ///< of the first replica
  std::vector<Replica> replicas;
  std::vector<Dataset> results;             ///< merged; paths as in observables.h5
  std::map<std::string, Measured> numbers;  ///< merged from the summaries: "temperature/small", "collision_rate" ...

  [[nodiscard]] double packing_fraction() const { return config.system.packing_fraction; }
  [[nodiscard]] double restitution() const { return config.collision.restitution; }
  [[nodiscard]] double length() const;  ///< collisions per disk measured, all replicas together
  [[nodiscard]] Measured number(const std::string& path) const;  ///< NaN when it was not measured
};

/// A run that gives no data, and why: not started, not finished, damaged.
struct AbsentRun {
  std::string path, why;
};

struct Study {
  std::filesystem::path folder;
  std::vector<StatePoint> points;  ///< by packing fraction, then restitution, then name
  std::vector<std::string> axes;   ///< further keys in which the points differ
  std::vector<AbsentRun> absent;   ///< by path
};

/// Reads every run under `folder` (itself may be one): a folder with config.toml, summary.json and observables.h5. A
/// run without a summary is unfinished; one that cannot be read is passed over; both are named in `absent`, and so are
/// the runs that manifest.tsv (tab-separated, with a header that has a column `path`) expects and that are not there.
/// Throws InputError when the folder cannot be read, the manifest makes no sense, or no run is under it.
Study read_study(const std::filesystem::path& folder, const Progress& progress = {});

/// The absent runs for a terminal: a line each, ten of them; the others are counted (csv/runs.csv and the report name
/// them all).
std::string describe_absent(const Study& study);

/// Writes `folder`/study.h5 and `folder`/csv/*.csv, each whole or not at all. Throws RunError, InputError.
void write_study(const Study& study, const std::filesystem::path& folder);

/// Both.
Study collect_study(const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace sandglass
