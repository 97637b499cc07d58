// From a study file to the points of a sweep: pure functions of the text.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sandglass/io/config.h"

namespace sandglass {

/// The points of a sweep, no two of them the same physics, in the order of the file.
struct SweepPlan {
  /// Keys that tell the points apart, in the order of the configuration table; run.seed is not among them. These are
  /// the keys that blocks give as lists, or in points, and that take more than one value; of the others that differ as
  /// many as are needed.
  std::vector<std::string> axes;
  std::vector<Config> points;
  std::uint64_t repeated = 0;  ///< points that were given more than once
};

/// Expands a study: a configuration with a table [sweep].
///
///     [sweep]
///     replicas = 3                                    # seeds run.seed, run.seed + 1, ...
///     [[sweep.product]]                               # every combination of the lists
///     system.packing_fraction = [0.70, 0.75]
///     collision.restitution = [0.9, 0.7]
///     run.collisions = 1e5                            # a value: for all points of this block
///     [[sweep.zip]]                                   # lists of one length, side by side
///     [[sweep.point]]                                 # one point
///
/// `assignments` ("key=value") act on every point, after the blocks; `scale` multiplies run.collisions, and then the
/// replicas are made. Every point is checked as a run is. Throws InputError naming file, line, key and point.
SweepPlan read_study(const std::filesystem::path& file, const std::vector<std::string>& assignments = {},
                     double scale = 1);
SweepPlan read_study_text(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                          const std::vector<std::string>& assignments = {}, double scale = 1);

/// The value of a key in a configuration, as config.toml has it.
std::string value_text(const Config& config, std::string_view key);

/// All physics keys with their values: two configurations are the same run if this is the same.
std::string physics_text(const Config& config);

/// Names that are safe as folders and sort as their numbers do, such as eta=0.80_eps=0.90_seed=1: the axes of the plan
/// and the seed, digits aligned over all points.
std::vector<std::string> point_names(const SweepPlan& plan);

}  // namespace sandglass
