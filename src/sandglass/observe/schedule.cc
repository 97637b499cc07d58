#include "sandglass/observe/schedule.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
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

std::uint64_t affordable_structure_frames(const MeasurementPlan& plan, double mean_free_time) {
  constexpr double free_times_per_frame = 1500;
  const double affordable = (plan.end() - plan.start) / (mean_free_time * free_times_per_frame);
  return static_cast<std::uint64_t>(std::clamp(affordable, 5.0, 20.0));
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

void put_in_order(Schedule& schedule) {
  std::sort(schedule.due.begin(), schedule.due.end());
  schedule.origins.assign(schedule.lags.size(), 0);
  for (const Due& due : schedule.due)
    if (due.kind != Due::Kind::new_origin) ++schedule.origins[due.lag];
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
    const std::uint64_t origins = level == 0 ? 1 : plan.origins;
    const auto kind = level + 1 == schedule.levels ? Due::Kind::new_compared_origin : Due::Kind::new_origin;
    for (std::uint64_t k = 0; k < origins; ++k) {
      const double origin = static_cast<double>(k) * plan.interval_length / static_cast<double>(plan.origins);
      schedule.due.push_back({origin, kind, level, 0});
      for (std::uint32_t lag = 1; lag < schedule.lags.size(); ++lag) {
        if (schedule.level_of_lag[lag] == level)
          schedule.due.push_back({origin + schedule.lags[lag], Due::Kind::evaluate, level, lag});
      }
    }
  }
  put_in_order(schedule);
  return schedule;
}

Schedule make_frame_schedule(const MeasurementPlan& plan, std::uint64_t frames) {
  check(plan);
  const double step = plan.interval_length / static_cast<double>(frames);
  const auto time = [&](std::uint64_t frame) {  // the end of the interval to the bit
    return frame == frames ? plan.interval_length : static_cast<double>(frame) * step;
  };
  std::vector<std::uint64_t> lags{0};
  for (double j = 0; lags.back() < frames; ++j) {
    const double wanted = portable_exp(j * (std::numbers::ln10 / plan.lags_per_decade));
    const auto lag = std::min(frames, static_cast<std::uint64_t>(wanted + 0.5));
    if (lag > lags.back()) lags.push_back(lag);
  }
  Schedule schedule;
  const std::uint64_t stride = (frames + most_origins - 1) / most_origins;
  for (std::uint64_t origin = 0; origin < frames; origin += stride) {
    const std::uint32_t level = schedule.levels++;
    schedule.due.push_back({time(origin), Due::Kind::new_compared_origin, level, 0});
    for (std::uint32_t lag = 1; lag < lags.size() && origin + lags[lag] <= frames; ++lag)
      schedule.due.push_back({time(origin + lags[lag]), Due::Kind::evaluate, level, lag});
  }
  for (const std::uint64_t lag : lags) schedule.lags.push_back(time(lag));
  put_in_order(schedule);
  return schedule;
}

std::size_t Schedule::evaluations() const { return std::accumulate(origins.begin(), origins.end(), std::size_t{0}); }

std::size_t Schedule::frames() const {
  std::size_t count = 0;
  double last = -1;
  for (const Due& d : due) {
    if (d.offset != last) ++count;
    last = d.offset;
  }
  return count;
}

std::size_t Schedule::nearest_lag(double time) const {
  std::size_t nearest = lags.size() - 1;
  const auto ratio = [&](std::size_t lag) { return std::max(lags[lag] / time, time / lags[lag]); };
  for (std::size_t lag = nearest; lag > 0; --lag)
    if (ratio(lag) < ratio(nearest)) nearest = lag;
  return nearest;
}

std::vector<std::size_t> Schedule::one_lag_per_decade() const {
  constexpr int most = 6;
  std::vector<std::size_t> list;
  double wanted = lags.back();
  for (int j = 0; j < most && wanted >= lags[1] * 0.99; ++j, wanted /= 10) {
    const std::size_t lag = nearest_lag(wanted);
    if (list.empty() || list.back() != lag) list.push_back(lag);
  }
  std::reverse(list.begin(), list.end());
  return list;
}

}  // namespace sandglass
