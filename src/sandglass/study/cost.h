// What a run will cost: by a table for its order among others, by a short probe for its time on this machine.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sandglass/core/progress.h"
#include "sandglass/io/config.h"

namespace sandglass {

/// Core-seconds that a run takes on the machine of bench/RESULTS.md: preparation, the windows of the calibration,
/// equilibration and measurement at nanoseconds per collision that depend on density, size and drive.
double reference_seconds(const Config& config);

/// Bytes that the folder of a finished run holds: both checkpoints, the trajectory, observables and report.
double expected_bytes(const Config& config);

/// How this machine compares with the table.
struct Pace {
  std::vector<std::pair<double, double>> factors{{0.5, 1.0}};  ///< packing fraction, this machine's time / the table's

  [[nodiscard]] double seconds(const Config& config) const;  ///< reference_seconds times the factor at its density
};

/// Relative uncertainty of Pace::seconds summed over `configs`: what the probes of test campaigns were off by, more
/// beyond 10^4 disks, where the table extrapolates from a small probe.
double pace_uncertainty(std::span<const Config> configs);

/// Measures: a few state points of the campaign, of at most 4000 disks each, simulated and sampled for half a second of
/// processor time, which other work on the machine changes little.
Pace probe_pace(std::span<const Config> configs, const Progress& progress = {});

}  // namespace sandglass
