#include "sandglass/observe/schedule.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <utility>

#include "sandglass/core/errors.h"

using namespace sandglass;

TEST_CASE("lags are distinct, log-spaced and end exactly at the interval") {
  MeasurementPlan plan;
  plan.interval_length = 37.3;
  plan.shortest_lag = 0.0005;
  plan.lags_per_decade = 12;
  const Schedule schedule = make_schedule(plan);
  CHECK(schedule.lags.front() == 0.0);
  CHECK(schedule.lags.back() == 37.3);
  // log10(37.3 / 0.0005) * 12 = 58.5 steps, rounded to 58 or 59.
  CHECK(std::fabs(static_cast<double>(schedule.lags.size()) - 60.5) <= 0.5);
  for (std::size_t lag = 2; lag < schedule.lags.size(); ++lag)
    CHECK(schedule.lags[lag] / schedule.lags[lag - 1] == doctest::Approx(std::pow(10, 1.0 / 12)).epsilon(1e-12));
}

TEST_CASE("every evaluation finds the origin it needs, for any plan") {
  const bool ok = rc::check("schedule", [] {
    MeasurementPlan plan;
    plan.interval_length = *rc::gen::inRange(1, 100000) * 0.01;
    plan.shortest_lag = plan.interval_length / *rc::gen::inRange(1, 1000000);
    plan.lags_per_decade = *rc::gen::inRange(10, 400) * 0.1;
    plan.origins = *rc::gen::inRange<std::uint64_t>(1, 9);
    const Schedule schedule = make_schedule(plan);
    std::vector<double> origin(schedule.levels, -1);
    std::vector<std::uint64_t> done(schedule.lags.size(), 0);
    double last = 0;
    for (const Due& due : schedule.due) {
      RC_ASSERT(due.offset >= last && due.offset <= plan.interval_length);
      last = due.offset;
      if (due.kind != Due::Kind::evaluate) {
        origin[due.level] = due.offset;
        continue;
      }
      RC_ASSERT(due.lag > 0 && schedule.level_of_lag[due.lag] == due.level && origin[due.level] >= 0);
      RC_ASSERT(origin[due.level] + schedule.lags[due.lag] == due.offset);
      ++done[due.lag];
    }
    for (std::size_t lag = 1; lag < done.size(); ++lag)
      RC_ASSERT(done[lag] == (schedule.level_of_lag[lag] == 0 ? 1 : plan.origins) &&
                done[lag] == schedule.origins[lag]);
  });
  CHECK(ok);
}

TEST_CASE("a plan costs at most one evaluation per four mean free times where an interval has 500 of them") {
  for (const double free_times : {500.0, 1000.0, 3000.0, 1e5}) {
    const MeasurementPlan plan = plan_measurement(10, free_times * 0.025, 10, 0.025, 12, {0.5, 3});
    const Schedule schedule = make_schedule(plan);
    CHECK(static_cast<double>(schedule.evaluations()) <= free_times / 4);
    CHECK(static_cast<double>(plan.temperature_samples) <= free_times / 20);
    CHECK(schedule.lags[1] == doctest::Approx(0.025 / 50).epsilon(0.11));  // half a step of 10^(1/12)
  }
  CHECK(plan_measurement(0, 2500, 10, 0.025, 12, {}).origins == 8);
  CHECK_THROWS_AS(plan_measurement(0, 0.01, 10, 0.025, 12, {}), InputError);
}

TEST_CASE("stored frames: every pair within an interval at every lag, or every so manieth") {
  for (const std::uint64_t frames : {1, 2, 7, 100, 128, 129, 1000}) {
    MeasurementPlan plan;
    plan.interval_length = 0.3 * static_cast<double>(frames);
    plan.shortest_lag = 0.3;
    const Schedule schedule = make_frame_schedule(plan, frames);
    CHECK(schedule.levels <= most_origins);
    CHECK(schedule.lags.back() == plan.interval_length);
    const std::uint64_t stride = (frames + 127) / 128;
    std::vector<double> origin(schedule.levels, -1);
    for (const Due& due : schedule.due) {
      if (due.kind != Due::Kind::evaluate) {
        origin[due.level] = due.offset;
        continue;
      }
      CHECK(origin[due.level] + schedule.lags[due.lag] == doctest::Approx(due.offset).epsilon(1e-12));
    }
    for (std::size_t lag = 1; lag < schedule.lags.size(); ++lag) {
      const auto steps = static_cast<std::uint64_t>(std::llround(schedule.lags[lag] / 0.3));
      CHECK(schedule.origins[lag] == (frames - steps) / stride + 1);
    }
  }
}

TEST_CASE("lags by their time: the nearest, and one per decade") {
  MeasurementPlan plan;
  plan.interval_length = 50;
  plan.shortest_lag = 0.05;
  const Schedule schedule = make_schedule(plan);
  CHECK(schedule.nearest_lag(1e9) == schedule.lags.size() - 1);
  CHECK(schedule.nearest_lag(1e-9) == 1);
  CHECK(schedule.lags[schedule.nearest_lag(5.1)] == doctest::Approx(5));
  const auto decades = schedule.one_lag_per_decade();
  REQUIRE(decades.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(schedule.lags[decades[i]] == doctest::Approx(0.05 * std::pow(10.0, static_cast<double>(i))).epsilon(1e-9));
}

TEST_CASE("the frames of the static structure: 5 to 20, one per 1500 mean free times") {
  MeasurementPlan plan;
  plan.intervals = 10;
  for (const auto& [length, frames] : {std::pair{1.0, 5}, {1100.0, 7}, {1e9, 20}}) {
    plan.interval_length = length;
    CHECK(affordable_structure_frames(plan, 1) == static_cast<std::uint64_t>(frames));
  }
}
