#include "sandglass/observe/thermodynamics.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sandglass/core/errors.h"

using namespace sandglass;

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

Population four_disks() {
  State state;
  state.box_length = 20;
  state.disks.resize(4);
  state.disks[1].species = state.disks[2].species = big;
  return population_of(state);
}

// Small disks at +-v along x, big ones at +-w along y, all on a wind that is not heat: T_small = v^2 / 2,
// T_big = m_b w^2 / 2, with v^2 = 2 + t and m_b w^2 = 1.
void make(double time, Frame& frame) {
  const double v = std::sqrt(2 + time), w = 1 / 1.43;
  frame.time = time;
  frame.collisions_per_disk = 30 * time + time * time;
  frame.x = frame.y = {0, 0, 0, 0};
  frame.vx = {5 + v, 5, 5, 5 - v};
  frame.vy = {2, 2 + w, 2 - w, 2};
}

template <class Observer>
void feed(Observer& observer, double end) {
  Frame frame;
  while (observer.next_sample() <= end) {
    make(observer.next_sample(), frame);
    observer.sample(frame);
  }
}

void copy_fields(std::vector<Field> from, std::vector<Field> to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    std::visit([&](auto* source) { *std::get<decltype(source)>(to[i].target) = *source; }, from[i].target);
}

const std::vector<double>& values(const Dataset& d) { return std::get<std::vector<double>>(d.values); }

}  // namespace

TEST_CASE("time series: log-spaced, temperatures relative to the centre of mass") {
  Timeseries series(four_disks(), 0.01, 10);
  feed(series, 100.5);
  const auto results = series.results();
  REQUIRE(results.size() == 5);
  const auto& time = values(results[0]);
  REQUIRE(time.size() == 42);  // 0 and 0.01 ... 100 in four decades of ten
  CHECK(time[0] == 0);
  for (std::size_t j = 1; j < time.size(); ++j)
    CHECK(time[j] == doctest::Approx(0.01 * std::pow(10, 0.1 * static_cast<double>(j - 1))).epsilon(1e-12));
  for (std::size_t j = 0; j < time.size(); ++j) {
    const double t = time[j];
    CHECK(values(results[1])[j] == 30 * t + t * t);
    CHECK(values(results[2])[j] == doctest::Approx((3 + t) / 4).epsilon(1e-12));
    CHECK(values(results[3])[j] == doctest::Approx((2 + t) / 2).epsilon(1e-12));
    CHECK(values(results[4])[j] == doctest::Approx(0.5).epsilon(1e-12));
  }
  Timeseries resumed(four_disks(), 0.01, 10), twin = series;
  feed(resumed, 3);
  Timeseries restored(four_disks(), 0.01, 10);
  copy_fields(resumed.fields(), restored.fields());
  feed(restored, 100.5);
  for (std::size_t i = 0; i < results.size(); ++i) CHECK(values(restored.results()[i]) == values(results[i]));
  twin.merge(series);
  CHECK(values(twin.results()[2]) == values(results[2]));
  CHECK_THROWS_AS(twin.merge(resumed), RunError);
}

TEST_CASE("interval averages: temperatures and rates of each interval") {
  MeasurementPlan plan;
  plan.start = 1;
  plan.interval_length = 2;
  plan.intervals = 4;
  plan.temperature_samples = 8;
  IntervalAverages averages(plan, four_disks());
  feed(averages, plan.end());
  CHECK(averages.next_sample() == endless);
  const auto temperatures = averages.interval_temperatures(Group::small);
  const auto rates = averages.interval_collision_rates();
  REQUIRE(temperatures.size() == 4);
  REQUIRE(rates.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double a = 1 + 2.0 * static_cast<double>(i);
    // T = (2 + t) / 2 at t = a + j / 4, j = 0 ... 7: mean of t is a + 7/8. Rate: 30 + (b^2 - a^2) / (b - a) = 30 + a +
    // b.
    CHECK(temperatures[i] == doctest::Approx((2 + a + 0.875) / 2).epsilon(1e-12));
    CHECK(rates[i] == doctest::Approx(30 + 2 * a + 2).epsilon(1e-12));
  }
  // Standard error of 34, 38, 42, 46: deviations 6, 2, 2, 6: sqrt(80 / 12).
  CHECK(averages.collision_rate().value == doctest::Approx(40).epsilon(1e-12));
  CHECK(averages.collision_rate().error == doctest::Approx(std::sqrt(80.0 / 12)).epsilon(1e-12));
  CHECK(averages.temperature(Group::big).value == doctest::Approx(0.5).epsilon(1e-12));

  // Stopped anywhere and resumed: the same numbers; only whole intervals count.
  for (double cut = 0; cut < 10; cut += 0.25) {
    IntervalAverages before(plan, four_disks()), after(plan, four_disks());
    feed(before, cut);
    const double whole = std::floor((cut - plan.start) / plan.interval_length);
    CHECK(before.interval_collision_rates().size() == static_cast<std::size_t>(std::clamp(whole, 0.0, 4.0)));
    copy_fields(before.fields(), after.fields());
    feed(after, plan.end());
    for (std::size_t i = 0; i < averages.results().size(); ++i)
      CHECK(values(after.results()[i]) == values(averages.results()[i]));
    CHECK(after.part_temperatures() == averages.part_temperatures());
    CHECK(after.part_collision_rates() == averages.part_collision_rates());
  }

  // Three parts each, of 3, 3 and 2 samples, make at least ten: T and the rate by the same laws.
  const auto part_temperatures = averages.part_temperatures(), part_rates = averages.part_collision_rates();
  REQUIRE(part_temperatures.size() == 12);
  REQUIRE(part_rates.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) {
    const double first[] = {0, 0.75, 1.5, 2};
    const double a = 1 + 2.0 * static_cast<double>(i / 3) + first[i % 3], length = first[i % 3 + 1] - first[i % 3];
    CHECK(part_temperatures[i] == doctest::Approx((3 + a + (length - 0.25) / 2) / 4).epsilon(1e-12));
    CHECK(part_rates[i] == doctest::Approx(30 + 2 * a + length).epsilon(1e-12));
  }

  IntervalAverages twin = averages;
  twin.merge(averages);
  CHECK(twin.part_temperatures().size() == 24);
  CHECK(twin.interval_temperatures(Group::all).size() == 8);
  CHECK(twin.temperature(Group::all).value == doctest::Approx(averages.temperature(Group::all).value).epsilon(1e-12));
}
