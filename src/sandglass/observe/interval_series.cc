#include "sandglass/observe/interval_series.h"

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

}  // namespace sandglass
