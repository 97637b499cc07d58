// Displacements between two moments: mean square and mean fourth power.
#pragma once

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Adds sum_i (s |dr_i|)^2 to `square` and sum_i (s |dr_i|)^4 to `fourth` over the disks of `range`, dr_i the
/// displacement of disk i from `origin` to `now`, both relative to the centre of mass. `scale` s is a power of two that
/// brings short displacements up to order one, so that the quantum of ExactSum does not show.
void add_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, ExactSum& square,
                       ExactSum& fourth);

/// The power of two for lag `t`: 2^e with 1 <= 2^e t < 2 for t < 1 (thermal velocities are of order one), 1 otherwise.
double displacement_scale(double lag);

}  // namespace sandglass
