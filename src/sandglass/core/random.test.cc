#include "sandglass/core/random.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace sandglass;

TEST_CASE("Philox gives the words of its authors' known-answer test") {
  // Random123 1.14, kat_vectors: philox4x64 10, counter and key all zero.
  const auto words = random_words(0, static_cast<Stream>(0), 0, 0);
  CHECK(words[0] == 0x16554d9eca36314cu);
  CHECK(words[1] == 0xdb20fe9d672d0fdcu);
  CHECK(words[2] == 0xd7e772cee186176bu);
  CHECK(words[3] == 0x7e68b68aec7ba23bu);
}

TEST_CASE("uniform stays strictly inside (0, 1)") {
  CHECK(uniform(0) > 0);
  CHECK(uniform(~std::uint64_t{0}) < 1);
}

TEST_CASE("portable logarithm, sine and cosine agree with the C library") {
  for (std::uint64_t i = 0; i < 200000; ++i) {
    const auto words = random_words(1, Stream::probe, i, 0);
    const double u = uniform(words[0]);
    CHECK(std::fabs(portable_log(u) - std::log(u)) <= 4 * 0x1p-52 * std::fabs(std::log(u)));
    const double turns = (u - 0.5) * static_cast<double>(1 + words[1] % 1000);
    const auto [sine, cosine] = portable_sincos_turns(turns);
    // The reference loses accuracy in 2 pi * turns itself; take out whole turns first, exactly.
    const double rest = turns - std::nearbyint(turns);
    CHECK(std::fabs(sine - std::sin(2 * std::numbers::pi * rest)) < 8e-16);
    CHECK(std::fabs(cosine - std::cos(2 * std::numbers::pi * rest)) < 8e-16);
  }
  CHECK(portable_log(1) == 0);
  CHECK(portable_log(0x1p-53) == doctest::Approx(-53 * std::numbers::ln2).epsilon(1e-15));
}

TEST_CASE("Gaussian and exponential variates have the right moments") {
  constexpr int n = 1000000;
  double sum = 0, square = 0, fourth = 0, waiting = 0, product = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto words = random_words(7, Stream::probe, i, 1);
    const auto [a, b] = gaussian_pair(words[0], words[1]);
    sum += a + b;
    square += a * a + b * b;
    fourth += a * a * a * a + b * b * b * b;
    product += a * b;
    waiting += exponential(words[2]);
  }
  // Five standard errors each: var(x) = 1, var(x^2) = 2, var(x^4) = 96, var(ab) = 1, var(exponential) = 1.
  CHECK(std::fabs(sum / (2 * n)) < 5 / std::sqrt(2.0 * n));
  CHECK(std::fabs(square / (2 * n) - 1) < 5 * std::sqrt(2 / (2.0 * n)));
  CHECK(std::fabs(fourth / (2 * n) - 3) < 5 * std::sqrt(96 / (2.0 * n)));
  CHECK(std::fabs(product / n) < 5 / std::sqrt(1.0 * n));
  CHECK(std::fabs(waiting / n - 1) < 5 / std::sqrt(1.0 * n));
}
