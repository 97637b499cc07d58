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

MinimalExponent minimal_exponent(const IntervalSeries& series, double width) {
  MinimalExponent minimum;
  if (series.intervals == 0) return minimum;
  double lowest = std::numeric_limits<double>::infinity();
  LagRange where{0, 0};
  for (std::size_t first = 1; first < series.time.size(); ++first) {
    const double t1 = series.time[first], t2 = t1 * width;
    if (t2 > series.time.back() * (1 + 1e-9)) break;
    const LagRange range = lags_within(series, t1, t2);
    const double slope = log_slope(series, range, no_interval);
    if (slope < lowest) {
      lowest = slope;
      where = range;
    }
  }
  if (where.last == 0) return minimum;
  minimum.exponent =
      jackknife(series.intervals, [&](std::size_t left_out) { return log_slope(series, where, left_out); });
  minimum.time = std::sqrt(series.time[where.first] * series.time[where.last - 1]);
  return minimum;
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

namespace {

/// Slope at point 1 of the parabola through three points.
double middle_slope(double t0, double f0, double t1, double f1, double t2, double f2) {
  const double left = (f1 - f0) / (t1 - t0), right = (f2 - f1) / (t2 - t1);
  return (left * (t2 - t1) + right * (t1 - t0)) / (t2 - t0);
}

/// Integral of f over t from point 0 to point `last`: between two points h (f1 + f2) / 2 + h^2 (f1' - f2') / 12.
template <class Value>
double integral(const std::vector<double>& t, Value&& f, std::size_t last) {
  const auto slope = [&](std::size_t i) {
    if (i == 0 || i == last) {  // that of the parabola through the three points at the end
      const std::size_t a = i == 0 ? 0 : last - 2;
      const double middle = middle_slope(t[a], f(a), t[a + 1], f(a + 1), t[a + 2], f(a + 2));
      const std::size_t near = i == 0 ? 0 : last - 1;
      return 2 * (f(near + 1) - f(near)) / (t[near + 1] - t[near]) - middle;
    }
    return middle_slope(t[i - 1], f(i - 1), t[i], f(i), t[i + 1], f(i + 1));
  };
  double sum = 0;
  for (std::size_t i = 0; i < last; ++i) {
    const double h = t[i + 1] - t[i];
    sum += h * (f(i) + f(i + 1)) / 2 + h * h * (slope(i) - slope(i + 1)) / 12;
  }
  return sum;
}

}  // namespace

Estimate diffusion_from_velocities(const IntervalSeries& velocities, double t) {
  std::size_t last = 0;
  while (last + 1 < velocities.time.size() && velocities.time[last + 1] <= t * (1 + 1e-9)) ++last;
  if (velocities.intervals == 0 || last < 2) return {};
  return jackknife(velocities.intervals, [&](std::size_t left_out) {
    return integral(
               velocities.time, [&](std::size_t lag) { return velocities.mean(lag, left_out); }, last) /
           2;
  });
}

}  // namespace sandglass
