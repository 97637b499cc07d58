// Velocity autocorrelation between two moments, and its integral over the time between them.
#pragma once

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Adds sum_i v_i(origin) . v_i(now) over the disks of `range`, velocities relative to the centre of mass.
void add_velocity_products(const Snapshot& origin, const Snapshot& now, Range range, ExactSum& sum);

/// Adds sum_i v_i(origin) . dr_i, displacements dr_i to `now` relative to the centre of mass times `scale` (see msd.h):
/// per disk the integral of the velocity autocorrelation over the time between the moments, exactly, where the integral
/// of its values at log-spaced lags would add up their noise.
void add_velocity_displacements(const Snapshot& origin, const Snapshot& now, Range range, double scale, ExactSum& sum);

}  // namespace sandglass
