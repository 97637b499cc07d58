#include "sandglass/study/merge.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "sandglass/study/results.h"

namespace sandglass {
namespace {

constexpr double unknown = Measured{}.error;

/// An MSD t^1.5 * factor on 20 lags from `first` on, `step` apart in ln t.
RunResults run(double first, double factor, double step = 0.2, std::uint64_t count = 100) {
  const std::string group = "/dynamics/small/mean_square_displacement/";
  std::vector<double> time, collisions, value, error;
  for (int i = 0; i < 20; ++i) {
    time.push_back(first * std::exp(step * i));
    collisions.push_back(10 * time.back());
    value.push_back(factor * std::pow(time.back(), 1.5));
    error.push_back(0.01);
  }
  return {{{group + "time", {20}, time, "t"},
           {group + "collisions", {20}, collisions, ""},
           {group + "value", {20}, value, "R_s^2"},
           {group + "error", {20}, error, "R_s^2"},
           {group + "count", {20}, std::vector<std::uint64_t>(20, count), ""}},
          1000};
}

std::vector<double> msd(const std::vector<Dataset>& results, const char* part) {
  return numbers_of(results, std::string("/dynamics/small/mean_square_displacement/") + part);
}

}  // namespace

TEST_CASE("two runs of equal weight: mean and the larger of two errors") {
  // mean 2; within sqrt(0.1^2 + 0.1^2) / 2 = 0.0707; between sqrt(2/1 (1 + 1)) / 2 = 1.
  const Measured far = merge(std::vector<Sample>{{1, 0.1, 5}, {3, 0.1, 5}});
  CHECK(far.value == doctest::Approx(2));
  CHECK(far.error == doctest::Approx(1));
  // between sqrt(2 * 2 * 0.01^2) / 2 = 0.01: the runs' own errors are larger.
  const Measured close = merge(std::vector<Sample>{{1.99, 0.1, 5}, {2.01, 0.1, 5}});
  CHECK(close.value == doctest::Approx(2));
  CHECK(close.error == doctest::Approx(std::sqrt(0.02) / 2));
}

TEST_CASE("weights") {
  // W = 4, mean (1 * 10 + 3 * 2) / 4 = 4; within sqrt((1 * 0.4)^2 + (3 * 0.1)^2) / 4 = 0.125;
  // between sqrt(2 ((1 * 6)^2 + (3 * 2)^2)) / 4 = 3.
  const Measured merged = merge(std::vector<Sample>{{10, 0.4, 1}, {2, 0.1, 3}});
  CHECK(merged.value == doctest::Approx(4));
  CHECK(merged.error == doctest::Approx(3));
}

TEST_CASE("intervals are merged one by one") {
  const std::string group = "/dynamics/small/mean_square_displacement/";
  const auto with_intervals = [&](double shift) {
    RunResults r = run(1, 1);
    r.datasets.push_back({group + "interval", {2}, std::vector<double>{0, 1}, ""});
    std::vector<double> values(40);
    for (std::size_t i = 0; i < 40; ++i) values[i] = (i < 20 ? 1 : 5) + shift;
    r.datasets.push_back({group + "interval_value", {2, 20}, values, "R_s^2"});
    r.datasets.push_back({"/dynamics/interval", {2}, std::vector<double>{0, 1}, ""});
    r.datasets.push_back({"/dynamics/waiting_time", {2}, std::vector<double>{10 + shift, 20 + shift}, "t"});
    return r;
  };
  const auto merged = merge_results(std::vector{with_intervals(-0.5), with_intervals(0.5)});
  CHECK(numbers_of(merged, "/dynamics/waiting_time") == std::vector<double>{10, 20});
  const auto value = msd(merged, "interval_value"), error = msd(merged, "interval_error");
  REQUIRE(value.size() == 40);
  CHECK(value[0] == 1);
  CHECK(value[39] == 5);
  CHECK(error[0] == doctest::Approx(0.5));  // sqrt(2/1 (0.5^2 + 0.5^2)) / 2
}

TEST_CASE("what is unknown does not spoil the rest") {
  CHECK(std::isnan(merge({}).value));
  const Measured single = merge(std::vector<Sample>{{2, 0.3, 7}, {unknown, 0.1, 5}, {4, 0.1, 0}});
  CHECK(single.value == 2);
  CHECK(single.error == doctest::Approx(0.3));
  const Measured scatter = merge(std::vector<Sample>{{1, unknown, 1}, {3, 0.1, 1}});
  CHECK(scatter.value == doctest::Approx(2));
  CHECK(scatter.error == doctest::Approx(1));
}

TEST_CASE("the order of the runs does not matter, and the mean lies between them") {
  rc::check([] {
    std::vector<Sample> samples;
    for (int i = *rc::gen::inRange(1, 6); i > 0; --i)
      samples.push_back(
          {*rc::gen::inRange(-50, 50) * 0.1, *rc::gen::inRange(1, 9) * 0.1, *rc::gen::inRange(1, 9) * 1.0});
    const Measured merged = merge(samples);
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end(),
                                                 [](const Sample& a, const Sample& b) { return a.value < b.value; });
    RC_ASSERT(merged.value >= low->value - 1e-12);
    RC_ASSERT(merged.value <= high->value + 1e-12);
    std::reverse(samples.begin(), samples.end());
    RC_ASSERT(std::abs(merge(samples).value - merged.value) < 1e-12);
    RC_ASSERT(std::abs(merge(samples).error - merged.error) < 1e-12);
  });
}

TEST_CASE("curves on the same lags are merged lag by lag, bits of the lags unchanged") {
  const RunResults a = run(0.01, 1), b = run(0.01, 3);
  const auto merged = merge_results(std::vector{a, b});
  CHECK(msd(merged, "time") == msd(a.datasets, "time"));
  const auto value = msd(merged, "value"), one = msd(a.datasets, "value");
  REQUIRE(value.size() == 20);
  for (std::size_t i = 0; i < 20; ++i) CHECK(value[i] == doctest::Approx(2 * one[i]));
  CHECK(msd(merged, "count").front() == 200);
  const auto single = merge_results(std::vector{a});
  CHECK(msd(single, "value") == one);
  CHECK(msd(single, "error") == std::vector<double>(20, 0.01));
}

TEST_CASE("lags that are off by half a per cent are interpolated") {
  // ln y is a straight line in ln t, which the cubic follows to rounding.
  const auto merged = merge_results(std::vector{run(0.01, 1), run(0.01005, 1)});
  const auto time = msd(merged, "time"), value = msd(merged, "value"), s = msd(merged, "collisions");
  REQUIRE(time.size() == 20);
  CHECK(time == msd(run(0.01005, 1).datasets, "time"));
  for (std::size_t i = 0; i < 20; ++i) {
    CHECK(value[i] == doctest::Approx(std::pow(time[i], 1.5)).epsilon(1e-12));
    CHECK(s[i] == doctest::Approx(10 * time[i]).epsilon(1e-12));
  }
  for (const double count : msd(merged, "count")) CHECK(count == 200);
}

TEST_CASE("a run that reaches farther extends the curve") {
  const auto merged = merge_results(std::vector{run(0.01, 1), run(0.01, 1, 0.3)});
  const auto time = msd(merged, "time"), count = msd(merged, "count");
  CHECK(time == msd(run(0.01, 1, 0.3).datasets, "time"));
  CHECK(count.front() == 200);
  CHECK(count.back() == 100);
}

TEST_CASE("pieces that do not fit together are left out") {
  RunResults bad = run(0.01, 1);
  std::get<std::vector<double>>(bad.datasets[2].values).pop_back();
  const auto merged = merge_results(std::vector{bad, run(0.01, 3)});
  CHECK(msd(merged, "count").front() == 100);
}

}  // namespace sandglass
