// One measured quantity as a function of lag, kept apart by interval: means, errors, jackknife.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace sandglass {

/// A value with its standard error; NaN where it cannot be had.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
};

inline constexpr std::size_t no_interval = static_cast<std::size_t>(-1);

/// Means by (interval, lag), row-major, over finished intervals: every interval has the same number of samples at a
/// lag. Of a static quantity the "lags" are its abscissae and the intervals blocks of frames.
struct IntervalSeries {
  std::vector<double> time;  ///< the lags
  std::size_t intervals = 0;
  std::vector<double> means;
  std::vector<double> totals;  ///< sums of `means` over intervals, by lag

  /// Mean over all intervals, or over all but one; NaN without data.
  [[nodiscard]] double mean(std::size_t lag, std::size_t left_out = no_interval) const;
  [[nodiscard]] double interval_mean(std::size_t interval, std::size_t lag) const {
    return means[interval * time.size() + lag];
  }
  /// Mean with its standard error over the intervals, sqrt(sum_i (mean_i - mean)^2 / (n (n-1))).
  [[nodiscard]] Estimate estimate(std::size_t lag) const;
};

/// Mean of one value per interval, with its standard error.
Estimate mean_of_intervals(std::span<const double> values);

/// The intervals of a series merged into at most `most` blocks of equally many consecutive ones (the last may be
/// shorter), by (block, lag), lag 0 left out: a quantity against its waiting time in bounded room.
struct BlockedSeries {
  std::size_t intervals_per_block = 1, blocks = 0;
  std::vector<double> means;
};
BlockedSeries blocked(const IntervalSeries& series, std::size_t most);

/// Value and error of statistic(left_out), a function of means that leave one interval out, over `intervals`
/// independent intervals: sigma^2 = (n-1)/n sum_i (theta_i - <theta>)^2 [Efron 1982]. For a mean of equal counts this
/// is the standard error. Intervals must be longer than the correlation time, otherwise the error comes out too small.
template <class Statistic>
Estimate jackknife(std::size_t intervals, Statistic&& statistic) {
  Estimate estimate;
  estimate.value = statistic(no_interval);
  if (intervals < 2) return estimate;
  std::vector<double> without(intervals);
  double mean = 0;
  for (std::size_t i = 0; i < intervals; ++i) mean += without[i] = statistic(i);
  const auto n = static_cast<double>(intervals);
  mean /= n;
  double squares = 0;
  for (const double value : without) squares += (value - mean) * (value - mean);
  estimate.error = std::sqrt(squares * (n - 1) / n);
  return estimate;
}

}  // namespace sandglass
