// A measurement of a few disks, for tests: two intervals, two lags to a decade.
#pragma once

#include "sandglass/io/config.h"
#include "sandglass/study/measurement.h"

namespace sandglass {

inline constexpr double small_beat = 0.1;

inline Config small_config() {
  Config config;
  config.run.intervals = 2;
  config.observe.lags_per_decade = 2;
  return config;
}

inline MeasurementPlan small_plan(const State& state) {
  const Config config = small_config();
  return plan_measurement(state.time(), 10, config.run.intervals, small_beat, config.observe.lags_per_decade,
                          config.observe.wavenumbers);
}

}  // namespace sandglass
