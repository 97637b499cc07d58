// Numbers read off time correlations: exponents, passage and decay times, diffusion.
#pragma once

#include "sandglass/observe/interval_series.h"

namespace sandglass {

/// Exponent of y = A t^alpha over t1 <= t <= t2: least squares of ln y against ln t with equal weights (log-spaced lags
/// then weigh every part of the range alike). The error is a jackknife over the intervals, so correlations between lags
/// are in it. NaN with fewer than two lags in the range.
Estimate power_law_exponent(const IntervalSeries& series, double t1, double t2);

/// The earliest time at which the series reaches `level` from below, interpolated linearly in ln t, ln y (before the
/// first lag: as free flight, y ~ t^2); jackknife error. NaN when it never does (also when one of the jackknife curves
/// does not: then the error is NaN).
Estimate passage_time(const IntervalSeries& series, double level);

/// D = (1/4) d MSD / dt at t: difference quotient between the outermost lags inside [t / spread, t * spread].
Estimate diffusion_coefficient(const IntervalSeries& series, double t, double spread = 1.5);

/// The earliest time at which a series that starts at 1 falls to `level`, interpolated linearly in ln t (before the
/// first lag linearly in t); jackknife error. NaN when it never does.
Estimate decay_time(const IntervalSeries& series, double level);

/// The series at t, interpolated linearly between the lags around it; jackknife error. NaN outside the lags.
Estimate value_at(const IntervalSeries& series, double t);

}  // namespace sandglass
