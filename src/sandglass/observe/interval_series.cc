#include "sandglass/observe/interval_series.h"

#include <algorithm>

namespace sandglass {

double IntervalSeries::mean(std::size_t lag, std::size_t left_out) const {
  double sum = totals[lag], count = static_cast<double>(intervals);
  if (left_out != no_interval) {
    sum -= means[left_out * time.size() + lag];
    count -= 1;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

Estimate IntervalSeries::estimate(std::size_t lag) const {
  std::vector<double> values(intervals);
  for (std::size_t interval = 0; interval < intervals; ++interval)
    values[interval] = means[interval * time.size() + lag];
  return mean_of_intervals(values);
}

Estimate mean_of_intervals(std::span<const double> values) {
  Estimate estimate;
  if (values.empty()) return estimate;
  const auto n = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  estimate.value = sum / n;
  if (values.size() < 2) return estimate;
  for (const double value : values) squares += (value - estimate.value) * (value - estimate.value);
  estimate.error = std::sqrt(squares / (n * (n - 1)));
  return estimate;
}

BlockedSeries blocked(const IntervalSeries& series, std::size_t most) {
  BlockedSeries result;
  const std::size_t lags = series.time.size();
  result.intervals_per_block = std::max<std::size_t>(1, (series.intervals + most - 1) / most);
  for (std::size_t first = 0; first < series.intervals; first += result.intervals_per_block, ++result.blocks) {
    const std::size_t last = std::min(first + result.intervals_per_block, series.intervals);
    for (std::size_t lag = 1; lag < lags; ++lag) {
      double sum = 0;
      for (std::size_t interval = first; interval < last; ++interval) sum += series.interval_mean(interval, lag);
      result.means.push_back(sum / static_cast<double>(last - first));
    }
  }
  return result;
}

}  // namespace sandglass
