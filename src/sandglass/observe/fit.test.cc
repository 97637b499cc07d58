#include "sandglass/observe/fit.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

// f(t) times 1 + noise_i, at lags 0 and 10^(-3 ... 3), 12 a decade. The noise of an interval may be common to all lags
// (`shared`) or independent at each.
template <class F>
IntervalSeries series_of(F&& f, std::size_t intervals, double noise, bool shared, std::uint64_t seed) {
  IntervalSeries series;
  series.time.push_back(0);
  for (int j = 0; j <= 72; ++j) series.time.push_back(std::pow(10.0, -3 + j / 12.0));
  series.intervals = intervals;
  series.totals.assign(series.time.size(), 0);
  for (std::size_t i = 0; i < intervals; ++i) {
    for (std::size_t lag = 0; lag < series.time.size(); ++lag) {
      const auto words = random_words(seed, Stream::probe, i, shared ? 0 : lag);
      const double factor = 1 + noise * gaussian_pair(words[0], words[1])[0];
      series.means.push_back(lag == 0 ? 0 : f(series.time[lag]) * factor);
      series.totals[lag] += series.means.back();
    }
  }
  return series;
}

}  // namespace

TEST_CASE("an exact power law gives its exponent, to rounding") {
  const auto series = series_of([](double t) { return 0.3 * std::pow(t, 0.547); }, 5, 0, true, 1);
  const Estimate exponent = power_law_exponent(series, 1, 10);
  CHECK(exponent.value == doctest::Approx(0.547).epsilon(1e-12));
  CHECK(exponent.error < 1e-12);
  CHECK(std::isnan(power_law_exponent(series, 2000, 3000).value));
  // Noise common to all lags moves the prefactor, not the exponent: the jackknife knows.
  CHECK(power_law_exponent(series_of([](double t) { return t; }, 10, 0.05, true, 2), 1, 10).error < 1e-12);
}

TEST_CASE("the jackknife error of an exponent is its true spread") {
  // 13 lags in 1 ... 10, x = ln t in steps h = ln(10)/12: sum x^2 = 182 h^2. With noise 0.05 in each of 20 intervals
  // the exponent has sigma = 0.05 / sqrt(20) / (sqrt(182) h) = 4.3e-3.
  const double sigma = 0.05 / std::sqrt(20.0) / (std::sqrt(182.0) * std::log(10.0) / 12);
  double spread = 0, claimed = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto series = series_of([](double t) { return t; }, 20, 0.05, false, seed);
    const Estimate exponent = power_law_exponent(series, 1, 10);
    spread += (exponent.value - 1) * (exponent.value - 1) / 200;
    claimed += exponent.error * exponent.error / 200;
  }
  CHECK(spread == doctest::Approx(sigma * sigma).epsilon(5 * 0.1));     // sqrt(2 / 200)
  CHECK(claimed == doctest::Approx(sigma * sigma).epsilon(5 * 0.023));  // sqrt(2 / 19 / 200)
}

TEST_CASE("passage time") {
  // Linear in logarithms: exact for a power law. t^0.5 = 1 / 0.4 at t = 6.25.
  const auto series = series_of([](double t) { return 0.4 * std::sqrt(t); }, 10, 0, true, 3);
  CHECK(passage_time(series, 1).value == doctest::Approx(6.25).epsilon(1e-10));
  CHECK(std::isnan(passage_time(series, 100).value));
  // Before the first lag: free flight, y ~ t^2.
  CHECK(passage_time(series, 1e-9).value ==
        doctest::Approx(series.time[1] * std::sqrt(1e-9 / series.mean(1))).epsilon(1e-10));
  // Common noise of 2 % in 10 intervals: dt / t = 2 * 0.02 / sqrt(10) = 1.26 %; a sample of one.
  const Estimate noisy = passage_time(series_of([](double t) { return 0.4 * std::sqrt(t); }, 10, 0.02, true, 4), 1);
  CHECK(std::fabs(noisy.value / 6.25 - 1) < 5 * 0.0126);
  // The error of ten values has a relative sigma of 1 / sqrt(18) = 0.24.
  CHECK(noisy.error / 6.25 == doctest::Approx(0.0126).epsilon(4 * 0.24));
}

TEST_CASE("diffusion is the slope of a straight line") {
  const auto line = series_of([](double t) { return 0.7 + 4 * 0.03 * t; }, 5, 0, true, 6);
  CHECK(diffusion_coefficient(line, 50).value == doctest::Approx(0.03).epsilon(1e-10));
  CHECK(std::isnan(diffusion_coefficient(line, 1e5).value));
}

namespace {

// The same with a value at lag 0, as correlations have it.
template <class F>
IntervalSeries correlation_of(F&& f, std::size_t intervals, double noise, std::uint64_t seed) {
  IntervalSeries series = series_of([](double) { return 0; }, intervals, 0, true, 0);
  series.totals.assign(series.time.size(), 0);
  for (std::size_t i = 0; i < intervals; ++i) {
    for (std::size_t lag = 0; lag < series.time.size(); ++lag) {
      const auto words = random_words(seed, Stream::probe, i, lag);
      double& mean = series.means[i * series.time.size() + lag];
      mean = f(series.time[lag]) + noise * gaussian_pair(words[0], words[1])[0];
      series.totals[lag] += mean;
    }
  }
  return series;
}

}  // namespace

TEST_CASE("decay time: linear in ln t, and in t before the first lag") {
  // 1 - 0.1 ln(t / 0.001) is 1/2 at t = 0.001 e^5.
  const auto series = correlation_of([](double t) { return t > 0 ? 1 - 0.1 * std::log(t / 0.001) : 1; }, 6, 0, 1);
  CHECK(decay_time(series, 0.5).value == doctest::Approx(0.001 * std::exp(5)).epsilon(1e-10));
  CHECK(decay_time(series, 0.5).error < 1e-10);
  CHECK(std::isnan(decay_time(series, -0.5).value));
  const auto fast = correlation_of([](double t) { return t > 0 ? 0.2 : 1; }, 6, 0, 1);
  CHECK(decay_time(fast, 0.6).value == doctest::Approx(0.0005).epsilon(1e-10));
  // dS / d ln t = 0.1 and S is known to 0.01 / sqrt(20) there: 2.2 % of t; the slope between two lags, and the error of
  // 20 intervals, are themselves only good to some 16 %.
  const auto noisy = correlation_of([](double t) { return t > 0 ? 1 - 0.1 * std::log(t / 0.001) : 1; }, 20, 0.01, 5);
  const Estimate time = decay_time(noisy, 0.5);
  CHECK(time.error < 0.04 * time.value);
  CHECK(std::fabs(time.value - 0.001 * std::exp(5)) < 5 * time.error);
}

TEST_CASE("a value between two lags is that of the line through them, with its error") {
  const auto line = correlation_of([](double t) { return 3 + 2 * t; }, 5, 0, 1);
  CHECK(value_at(line, 0).value == doctest::Approx(3).epsilon(1e-14));
  CHECK(value_at(line, 0.37).value == doctest::Approx(3.74).epsilon(1e-12));
  CHECK(value_at(line, line.time.back()).value == doctest::Approx(3 + 2 * line.time.back()).epsilon(1e-12));
  CHECK(std::isnan(value_at(line, 1.01 * line.time.back()).value));
  CHECK(std::isnan(value_at({}, 0).value));
  // At a lag the error is that of its mean over the intervals.
  const auto noisy = correlation_of([](double t) { return t; }, 12, 0.1, 3);
  CHECK(value_at(noisy, noisy.time[7]).error == doctest::Approx(noisy.estimate(7).error).epsilon(1e-6));
}

TEST_CASE("intervals merged into blocks keep their means, and their number is bounded") {
  const auto series = correlation_of([](double t) { return t; }, 23, 0.1, 7);
  const BlockedSeries all = blocked(series, 100), few = blocked(series, 10);
  CHECK(all.intervals_per_block == 1);
  CHECK(all.blocks == 23);
  CHECK(few.intervals_per_block == 3);
  CHECK(few.blocks == 8);
  const std::size_t lags = series.time.size() - 1;
  CHECK(all.means[2 * lags + 4] == series.interval_mean(2, 5));
  CHECK(few.means[7 * lags + 4] ==
        doctest::Approx((series.interval_mean(21, 5) + series.interval_mean(22, 5)) / 2).epsilon(1e-12));
}
