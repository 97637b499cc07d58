// What a run will cost: by a table for its order among others, by a short probe for its time on this machine.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sandglass/core/progress.h"
#include "sandglass/io/config.h"

namespace sandglass {

/// Seconds of one core that each kind of work takes.
struct Costs {
  double preparing = 1;   ///< a disk of the start
  double collision = 1;   ///< a collision at 10^4 disks, with the kicks that go with it
  double comparison = 1;  ///< a disk, when two moments are compared
  double structure = 1;   ///< a disk in a frame of the static structure
};

/// Core-seconds that a run takes on the machine of bench/RESULTS.md: preparation, the windows of the calibration,
/// equilibration and measurement, what is measured on the way, and the report. Each unit of work has a cost that
/// depends on density and drive, a collision also on the number of disks.
double reference_seconds(const Config& config);

/// Bytes that the folder of a finished run holds: both checkpoints, the trajectory, observables and report.
double expected_bytes(const Config& config);

/// How this machine compares with the table.
struct Pace {
  std::vector<std::pair<double, Costs>> factors{{0.5, {}}};  ///< packing fraction, this machine's times / the table's
  double large = 1;  ///< the same of a collision in large systems, beyond the factor of small ones

  [[nodiscard]] double seconds(const Config& config) const;  ///< reference_seconds with these factors
};

/// Relative uncertainty of Pace::seconds summed over `configs`: what the probes of test campaigns were off by, more
/// beyond 10^4 disks, where the table extrapolates in size, and memory on a busy machine is shared.
double pace_uncertainty(std::span<const Config> configs);

/// Measures: a few state points of the campaign, of at most 4000 disks each, prepared, simulated, and measured, each
/// for some tenths of a second of processor time, which other work on the machine changes little; and for systems
/// beyond 2 * 10^4 disks, one of 2 * 10^5.
Pace probe_pace(std::span<const Config> configs, const Progress& progress = {});

}  // namespace sandglass
