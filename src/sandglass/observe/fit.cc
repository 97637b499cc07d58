#include "sandglass/observe/fit.h"

#include <algorithm>

#include "sandglass/core/random.h"
#include "sandglass/observe/portable.h"

namespace sandglass {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Lags [first, last) with t1 <= t <= t2, lag 0 excluded. The ends are widened by rounding.
struct LagRange {
  std::size_t first, last;
};
LagRange lags_within(const IntervalSeries& series, double t1, double t2) {
  constexpr double slack = 1e-9;
  std::size_t first = 0;
  while (first < series.time.size() && !(series.time[first] > 0 && series.time[first] >= t1 * (1 - slack))) ++first;
  std::size_t last = first;
  while (last < series.time.size() && series.time[last] <= t2 * (1 + slack)) ++last;
  return {first, last};
}

double log_slope(const IntervalSeries& series, LagRange range, std::size_t left_out) {
  const auto n = static_cast<double>(range.last - range.first);
  if (n < 2) return nan;
  double mx = 0, my = 0, sxx = 0, sxy = 0;
  for (std::size_t lag = range.first; lag < range.last; ++lag) {
    mx += portable_log(series.time[lag]) / n;
    my += portable_log(series.mean(lag, left_out)) / n;
  }
  for (std::size_t lag = range.first; lag < range.last; ++lag) {
    const double dx = portable_log(series.time[lag]) - mx;
    sxx += dx * dx;
    sxy += dx * (portable_log(series.mean(lag, left_out)) - my);
  }
  return sxy / sxx;
}

}  // namespace

Estimate power_law_exponent(const IntervalSeries& series, double t1, double t2) {
  const LagRange range = lags_within(series, t1, t2);
  if (series.intervals == 0 || range.last - range.first < 2) return {};
  return jackknife(series.intervals, [&](std::size_t left_out) { return log_slope(series, range, left_out); });
}

Estimate passage_time(const IntervalSeries& series, double level) {
  if (series.intervals == 0) return {};
  return jackknife(series.intervals, [&](std::size_t left_out) {
    for (std::size_t lag = 1; lag < series.time.size(); ++lag) {
      const double above = series.mean(lag, left_out), below = series.mean(lag - 1, left_out);
      if (!(above >= level)) continue;
      if (!(series.time[lag - 1] > 0)) return series.time[lag] * std::sqrt(level / above);  // still free flight
      const double fraction = portable_log(level / below) / portable_log(above / below);
      return series.time[lag - 1] * portable_exp(fraction * portable_log(series.time[lag] / series.time[lag - 1]));
    }
    return nan;
  });
}

Estimate diffusion_coefficient(const IntervalSeries& series, double t, double spread) {
  const LagRange range = lags_within(series, t / spread, t * spread);
  if (series.intervals == 0 || range.last - range.first < 2) return {};
  const std::size_t a = range.first, b = range.last - 1;
  return jackknife(series.intervals, [&](std::size_t left_out) {
    return (series.mean(b, left_out) - series.mean(a, left_out)) / (4 * (series.time[b] - series.time[a]));
  });
}

Estimate decay_time(const IntervalSeries& series, double level) {
  if (series.intervals == 0) return {};
  return jackknife(series.intervals, [&](std::size_t left_out) {
    double before = 1;
    for (std::size_t lag = 1; lag < series.time.size(); ++lag) {
      const double t1 = series.time[lag - 1], t2 = series.time[lag], value = series.mean(lag, left_out);
      if (value <= level) {
        const double fraction = (before - level) / (before - value);
        return t1 > 0 ? t1 * portable_exp(fraction * portable_log(t2 / t1)) : t2 * fraction;
      }
      before = value;
    }
    return nan;
  });
}

Estimate value_at(const IntervalSeries& series, double t) {
  // Within a rounding of the longest lag is at it.
  const auto above = std::lower_bound(series.time.begin(), series.time.end(), t * (1 - 1e-9));
  if (series.intervals == 0 || above == series.time.end()) return {};
  const auto after = static_cast<std::size_t>(above - series.time.begin()), before = after > 0 ? after - 1 : 0;
  const double t1 = series.time[before], t2 = series.time[after];
  const double fraction = after > before ? std::fmin((t - t1) / (t2 - t1), 1) : 0;
  return jackknife(series.intervals, [&](std::size_t left_out) {
    return (1 - fraction) * series.mean(before, left_out) + fraction * series.mean(after, left_out);
  });
}

}  // namespace sandglass
