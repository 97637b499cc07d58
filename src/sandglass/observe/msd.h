// Displacements between two moments: mean square and fourth power, overlap, distribution.
#pragma once

#include <cstdint>

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Sums over disks of what their displacements dr_i from one moment to another, relative to the centre of mass, give.
struct DisplacementSums {
  ExactSum square, fourth;               ///< (s |dr|)^2 and (s |dr|)^4
  std::uint64_t overlapping = 0;         ///< disks with |dr| <= a
  std::uint64_t* by_distance = nullptr;  ///< where they are counted in the bins of van_hove.h; may be null
};

/// Adds the disks of `range` to `sums`. `scale` s is a power of two that brings short displacements up to order one, so
/// that the quantum of ExactSum does not show; `overlap_length` is a.
void add_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, double overlap_length,
                       DisplacementSums& sums);

/// The power of two for lag `t`: 2^e with 1 <= 2^e t < 2 for t < 1 (thermal velocities are of order one), 1 otherwise.
double displacement_scale(double lag);

}  // namespace sandglass
