#include "sandglass/observe/stationarity.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

std::vector<double> noisy_line(std::size_t n, double drift, double noise, std::uint64_t seed) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const auto words = random_words(seed, Stream::probe, i, 0);
    const double position = static_cast<double>(i) / static_cast<double>(n - 1) - 0.5;
    values.push_back(1 + drift * position + noise * gaussian_pair(words[0], words[1])[0]);
  }
  return values;
}

}  // namespace

TEST_CASE("a trend is found with the right size and error") {
  const Trend exact = trend(noisy_line(10, 0.3, 0, 1));
  CHECK(exact.mean == doctest::Approx(1));
  CHECK(exact.drift == doctest::Approx(0.3).epsilon(1e-12));
  CHECK(exact.drift_error < 1e-12);
  // Error of a slope: noise / sqrt(sum x^2); x = i - 4.5, sum x^2 = 82.5, times 9. Averaged over 1000 lines the mean
  // squared estimate is right to sqrt(2/8/1000) = 1.6 %.
  double squares = 0, spread = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Trend t = trend(noisy_line(10, 0.3, 0.1, seed));
    squares += t.drift_error * t.drift_error / 1000;
    spread += (t.drift - 0.3) * (t.drift - 0.3) / 1000;
  }
  const double expected = 0.01 / 82.5 * 81;
  CHECK(squares == doctest::Approx(expected).epsilon(0.08));
  CHECK(spread == doctest::Approx(expected).epsilon(5 * 0.045));  // sqrt(2/1000)
}

TEST_CASE("verdict: significant and relevant") {
  const auto flat = noisy_line(20, 0, 0.002, 5);
  CHECK(judge_stationarity(flat, flat).stationary);
  // 5 % over the stretch, noise 0.2 %: beyond doubt, in either quantity.
  CHECK_FALSE(judge_stationarity(noisy_line(20, 0.05, 0.002, 6), flat).stationary);
  CHECK_FALSE(judge_stationarity(flat, noisy_line(20, -0.05, 0.002, 7)).stationary);
  // Significant, but 0.5 % does not matter.
  CHECK(judge_stationarity(noisy_line(20, 0.005, 0.0001, 8), flat).stationary);
  // 2 % inside a noise of 10 %: nothing to see.
  CHECK(judge_stationarity(noisy_line(20, 0.02, 0.1, 9), flat).stationary);
  // Four intervals decide nothing.
  const auto few = noisy_line(4, 0, 0.002, 10);
  CHECK_FALSE(judge_stationarity(few, few).decided);
  CHECK_FALSE(judge_stationarity(few, few).stationary);
}

TEST_CASE("false alarms are as rare as stated") {
  // Ten intervals leave 8 degrees of freedom: |t| > 3 has probability 1.7 %; either of two quantities: 3.4 %. In 2000
  // trials 68 +- 8; relevance switched off.
  int alarms = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed)
    alarms += !judge_stationarity(noisy_line(10, 0, 0.1, 2 * seed), noisy_line(10, 0, 0.1, 2 * seed + 1), 0).stationary;
  CHECK(alarms > 68 - 40);
  CHECK(alarms < 68 + 40);
}
