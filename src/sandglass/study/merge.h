// Independent runs of one state point, merged into one set of results.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "sandglass/core/fields.h"

namespace sandglass {

struct Measured {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();  ///< standard error
};

/// What one run says about a number, and how much it is worth: the count of samples or the length measured.
struct Sample {
  double value = 0, error = 0, weight = 0;
};

/// The weighted mean v = sum w_r v_r / W of n runs, W = sum w_r, with the larger of two standard errors:
///   within   sqrt(sum (w_r e_r)^2) / W                       what the runs say of themselves,
///   between  sqrt(n / (n-1) sum (w_r (v_r - v))^2) / W       the scatter of independent starts.
/// The first is too small where the intervals of a run are shorter than its relaxation time, and in an ageing system;
/// the second scatters itself by 1 / sqrt(2(n-1)). Samples that are no number or weigh nothing are left out; an
/// unknown e_r leaves only the scatter; a single run has only its own error.
Measured merge(std::span<const Sample> samples);

/// The results of one run and the length of its measured stretch, in collisions per disk.
struct RunResults {
  std::vector<Dataset> datasets;
  double length = 0;
};

/// Merges every quantity that any of the runs holds (study/results.h), point by point. The lags are those of the run
/// that reaches farthest; the others, whose lags are off by a fraction of a per cent because each run sets them by its
/// own collision rate, are interpolated (cubic in ln t), as far as they reach. Other arguments must agree to 10^-9.
/// Weights are the counts, else the lengths.
std::vector<Dataset> merge_results(std::span<const RunResults> runs);

}  // namespace sandglass
