// Velocity autocorrelation between two moments.
#pragma once

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Adds sum_i v_i(origin) . v_i(now) over the disks of `range`, velocities relative to the centre of mass.
void add_velocity_products(const Snapshot& origin, const Snapshot& now, Range range, ExactSum& sum);

}  // namespace sandglass
