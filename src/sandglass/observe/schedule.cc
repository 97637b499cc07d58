#include "sandglass/observe/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"
#include "sandglass/observe/portable.h"

namespace sandglass {

std::vector<Field> MeasurementPlan::fields() {
  return {{"start", &start},
          {"interval_length", &interval_length},
          {"intervals", &intervals},
          {"shortest_lag", &shortest_lag},
          {"lags_per_decade", &lags_per_decade},
          {"origins", &origins},
          {"temperature_samples", &temperature_samples},
          {"wavenumbers", &wavenumbers},
          {"overlap_length", &overlap_length},
          {"selection_time", &selection_time},
          {"structure_frames", &structure_frames},
          {"bin_width", &bin_width}};
}

bool compatible(const MeasurementPlan& a, const MeasurementPlan& b) {
  MeasurementPlan shifted = b;
  shifted.start = a.start;
  return a == shifted;
}

MeasurementPlan plan_measurement(double start, double interval_length, std::uint64_t intervals, double mean_free_time,
                                 double lags_per_decade, std::vector<double> wavenumbers) {
  MeasurementPlan plan;
  plan.start = start;
  plan.interval_length = interval_length;
  plan.intervals = intervals;
  plan.shortest_lag = mean_free_time / 50;
  plan.lags_per_decade = lags_per_decade;
  plan.wavenumbers = std::move(wavenumbers);
  plan.origins = 1;
  if (!(mean_free_time > 0) || !(interval_length >= mean_free_time))
    throw InputError(
        "An interval of the measurement is shorter than one mean free time, so there is nothing to correlate "
        "in it; raise run.collisions or lower run.intervals.");
  const double free_times = interval_length / mean_free_time;
  plan.temperature_samples = static_cast<std::uint64_t>(std::clamp(free_times / 20, 5.0, 50.0));
  while (plan.origins < 8) {
    ++plan.origins;
    if (static_cast<double>(make_schedule(plan).evaluations()) > free_times / 4) {
      --plan.origins;
      break;
    }
  }
  return plan;
}

std::uint64_t affordable_structure_frames(std::uint64_t wanted, const MeasurementPlan& plan, double mean_free_time) {
  constexpr double free_times_per_frame = 1000;
  const double affordable = (plan.end() - plan.start) / (mean_free_time * free_times_per_frame);
  return std::min(wanted, static_cast<std::uint64_t>(std::max(2.0, affordable)));
}

namespace {

void check(const MeasurementPlan& plan) {
  if (!(plan.interval_length > 0) || !(plan.shortest_lag > 0) || plan.shortest_lag > plan.interval_length ||
      !(plan.lags_per_decade >= 1) || plan.intervals < 1 || plan.origins < 1 || plan.origins > 8 ||
      plan.temperature_samples < 1)
    throw InputError(
        "The plan of the measurement makes no sense (lengths must be positive, the shortest lag within an "
        "interval, at least one lag per decade, 1 to 8 origins); check run.intervals and observe.lags_per_decade.");
}

}  // namespace

Schedule make_schedule(const MeasurementPlan& plan) {
  check(plan);
  Schedule schedule;
  // From the longest lag down: lag j stands j / lags_per_decade decades below the interval.
  const double decades = portable_log(plan.interval_length / plan.shortest_lag) / std::numbers::ln10;
  const auto steps = static_cast<std::uint32_t>(decades * plan.lags_per_decade + 0.5);
  schedule.lags.assign(steps + 2, 0.0);
  schedule.level_of_lag.assign(steps + 2, 0);
  for (std::uint32_t j = 0; j <= steps; ++j) {
    const std::uint32_t lag = steps + 1 - j;
    schedule.lags[lag] =
        plan.interval_length * portable_exp(-static_cast<double>(j) * (std::numbers::ln10 / plan.lags_per_decade));
    schedule.level_of_lag[lag] = static_cast<std::uint32_t>(j / plan.lags_per_decade + 1e-9);
  }
  schedule.levels = schedule.level_of_lag[1] + 1;
  schedule.level_of_lag[0] = schedule.levels - 1;

  for (std::uint32_t level = 0; level < schedule.levels; ++level) {
    const std::uint64_t origins = schedule.origins(level, plan);
    for (std::uint64_t k = 0; k < origins; ++k) {
      const double origin = static_cast<double>(k) * plan.interval_length / static_cast<double>(plan.origins);
      schedule.due.push_back({origin, Due::Kind::new_origin, level, 0});
      for (std::uint32_t lag = 1; lag < schedule.lags.size(); ++lag) {
        if (schedule.level_of_lag[lag] == level)
          schedule.due.push_back({origin + schedule.lags[lag], Due::Kind::evaluate, level, lag});
      }
    }
  }
  std::sort(schedule.due.begin(), schedule.due.end());
  return schedule;
}

std::uint64_t Schedule::origins(std::uint32_t level, const MeasurementPlan& plan) const {
  return level == 0 ? 1 : plan.origins;
}

std::size_t Schedule::evaluations() const {
  return static_cast<std::size_t>(std::count_if(
      due.begin(), due.end(), [&](const Due& d) { return d.kind == Due::Kind::evaluate || d.level == levels - 1; }));
}

std::size_t Schedule::frames() const {
  std::size_t count = 0;
  double last = -1;
  for (const Due& d : due) {
    if (d.offset != last) ++count;
    last = d.offset;
  }
  return count;
}

}  // namespace sandglass
