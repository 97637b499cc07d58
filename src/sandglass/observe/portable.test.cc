#include "sandglass/observe/portable.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

using namespace sandglass;

TEST_CASE("cosine of turns is within 1e-13 of the true cosine, however many turns") {
  // For |u| <= 2^20 the fractional part of u is exact, so that the reference has no error but that of std::cos.
  for (int i = -4000; i <= 4000; ++i) {
    for (const double u : {i * 0.000251, i * 0.13777, i * 262.00173}) {
      const double r = u - std::nearbyint(u);
      CHECK(std::fabs(cosine_of_turns(u) - std::cos(2 * std::numbers::pi * r)) < 1e-13);
    }
  }
}

TEST_CASE("portable_exp is within 4e-16 relative of the true exponential") {
  // The reference is itself off by up to 1.1e-16 relative.
  for (int i = -7000; i <= 7000; ++i) {
    const double x = i * 0.0999;
    CHECK(std::fabs(portable_exp(x) / std::exp(x) - 1) < 5e-16);
  }
  CHECK(portable_exp(0) == 1.0);
  CHECK(portable_exp(-1000) == 0.0);
  CHECK(std::isinf(portable_exp(1000)));
  CHECK(std::isnan(portable_exp(std::nan(""))));
}
