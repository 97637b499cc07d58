// Is a measured stretch stationary? A trend against its noise.
#pragma once

#include <span>

namespace sandglass {

/// Straight line through one value per interval, or part of it, by least squares.
struct Trend {
  double mean = 0;
  double drift = 0;        ///< slope times the length of the stretch: change from its first to its last value
  double drift_error = 0;  ///< standard error from the residuals; the values are taken as independent
};
Trend trend(std::span<const double> values);

/// The verdict on temperature and collision rate. A quantity drifts when its trend is both significant
/// (|drift| > 3 drift_error) and relevant (|drift| > relevant * mean). Fewer than 5 values leave it undecided.
struct Stationarity {
  bool decided = false;
  bool stationary = false;  ///< false as well when undecided
  Trend temperature, collision_rate;
};
inline constexpr double relevant_drift = 0.01;
Stationarity judge_stationarity(std::span<const double> temperatures, std::span<const double> collision_rates,
                                double relevant = relevant_drift);

}  // namespace sandglass
