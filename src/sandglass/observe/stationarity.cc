#include "sandglass/observe/stationarity.h"

#include <cmath>

namespace sandglass {

Trend trend(std::span<const double> values) {
  Trend result;
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) result.mean += value / n;
  const double middle = (n - 1) / 2;
  double sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    sxx += x * x;
    sxy += x * (values[i] - result.mean);
  }
  if (values.size() < 3) return result;
  const double slope = sxy / sxx;
  double squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double residual = values[i] - result.mean - slope * (static_cast<double>(i) - middle);
    squares += residual * residual;
  }
  result.drift = slope * (n - 1);
  result.drift_error = std::sqrt(squares / (n - 2) / sxx) * (n - 1);
  return result;
}

Stationarity judge_stationarity(std::span<const double> temperatures, std::span<const double> collision_rates,
                                double relevant) {
  constexpr std::size_t enough = 5;
  constexpr double sigmas = 3;
  Stationarity verdict;
  verdict.temperature = trend(temperatures);
  verdict.collision_rate = trend(collision_rates);
  verdict.decided = temperatures.size() >= enough && collision_rates.size() >= enough;
  auto drifts = [&](const Trend& t) {
    return std::fabs(t.drift) > sigmas * t.drift_error && std::fabs(t.drift) > relevant * std::fabs(t.mean);
  };
  verdict.stationary = verdict.decided && !drifts(verdict.temperature) && !drifts(verdict.collision_rate);
  return verdict;
}

}  // namespace sandglass
