#include "sandglass/core/exact_sum.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "sandglass/core/errors.h"

using namespace sandglass;

TEST_CASE("the sum does not depend on the order of its terms") {
  CHECK(rc::check([](const std::vector<double>& raw) {
    std::vector<double> terms;
    for (const double term : raw)
      if (std::fabs(term) < 1e20) terms.push_back(term);
    ExactSum forward, backward, halves, upper;
    for (const double term : terms) forward.add(term);
    for (auto it = terms.rbegin(); it != terms.rend(); ++it) backward.add(*it);
    for (std::size_t i = 0; i < terms.size(); ++i) (i % 2 ? upper : halves).add(terms[i]);
    halves.add(upper);
    RC_ASSERT(forward == backward);
    RC_ASSERT(forward == halves);
    RC_ASSERT(forward == ExactSum::from_halves(forward.high(), forward.low()));
  }));
}

TEST_CASE("each term is rounded to the nearest quantum, small and large terms alike") {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> exponent(-60, 70);
  for (int i = 0; i < 100000; ++i) {
    const double term = std::exp2(exponent(generator)) * (i % 2 ? 1 : -1);
    ExactSum sum;
    sum.add(term);
    // Half a quantum from rounding the term, half an ulp from rounding the sum back to a double.
    CHECK(std::fabs(sum.value() - term) <= 0.5 * ExactSum::quantum + 0x1p-53 * std::fabs(term));
  }
}

TEST_CASE("eight terms at once are the same as one by one") {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> exponent(-60, 20);
  for (int i = 0; i < 1000; ++i) {
    double terms[8];
    ExactSum one_by_one, together;
    for (double& term : terms) {
      term = std::exp2(exponent(generator)) * (generator() % 2 ? 1 : -1);
      if (i % 2 == 0) term = std::fmod(term, 128);  // else some are beyond what can be added fast
      one_by_one.add(term);
    }
    together.add(terms);
    CHECK(one_by_one == together);
  }
  CHECK_THROWS_AS(ExactSum().add({1, 2, std::nan(""), 4, 5, 6, 7, 8}), RunError);
}

TEST_CASE("a sum that cancels is exactly zero") {
  ExactSum sum;
  for (const double term : {1e9, 0.1, 3e-7}) sum.add(term);
  for (const double term : {-3e-7, -1e9, -0.1}) sum.add(term);
  CHECK(sum.value() == 0);
}

TEST_CASE("values that are no numbers are refused") {
  ExactSum sum;
  CHECK_THROWS_AS(sum.add(std::nan("")), RunError);
  CHECK_THROWS_AS(sum.add(HUGE_VAL), RunError);
}
