#include "sandglass/observe/tally_averages.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/core/errors.h"

using namespace sandglass;

TEST_CASE("pressure of two disks on a ring is that of the Tonks gas") {
  // Two disks of diameter s and mass 1 at +-v on a line of length L: they meet every (L - 2 s) / (2 v) with impulse
  // 2 v. Exactly p L = N T_1 L / (L - N s) [Tonks 1936], so Z - 1 = 2 s / (L - 2 s); no momentum flows across the line,
  // where the ideal part is missing as well: Z is the same. The finite-size factor (N - 1) / N = 1/2 is on top.
  const double v = 1.7, s = 2, length = 30;
  const double between = (length - 2 * s) / (2 * v), temperature = v * v / 2;
  const double interval = 100 * between;
  std::vector<Tally> boundaries(4);
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    boundaries[i].contacts[0] = 100 * i;
    boundaries[i].virial.add(static_cast<double>(100 * i) * 2 * v * s);
  }
  const std::vector<double> temperatures(3, temperature);
  const TallyAverages averages = tally_averages(boundaries, interval, temperatures, {2, 0});
  CHECK(averages.compressibility_factor.value == doctest::Approx(1 + 0.5 * 2 * s / (length - 2 * s)).epsilon(1e-12));
  CHECK(averages.compressibility_factor.error < 1e-12);
  CHECK(averages.collision_rate.value == doctest::Approx(1 / between).epsilon(1e-12));
  CHECK(averages.partner_rate[small][small].value == doctest::Approx(1 / between).epsilon(1e-12));
}

TEST_CASE("rates by species, energy flow and their errors") {
  // 6 small, 4 big; an interval of 5 time units. Two intervals that differ, so that errors are |a - b| / 2.
  std::vector<Tally> boundaries(3);
  boundaries[1].contacts = {30, 24, 10};
  boundaries[2].contacts = {90, 48, 20};
  boundaries[1].kicked = {12, 8};
  boundaries[2].kicked = {24, 24};
  boundaries[2].elastic_contacts = 79;
  boundaries[1].injected.add(10);
  boundaries[2].injected.add(30);
  boundaries[2].dissipated.add(25);
  const std::vector<double> temperatures{1, 1};
  const TallyAverages averages = tally_averages(boundaries, 5, temperatures, {6, 4});
  auto check = [](const Estimate& estimate, double first, double second) {
    CHECK(estimate.value == doctest::Approx((first + second) / 2).epsilon(1e-12));
    CHECK(estimate.error == doctest::Approx(std::fabs(first - second) / 2).epsilon(1e-12));
  };
  check(averages.collision_rate, 2 * 64 / 50.0, 2 * 94 / 50.0);
  check(averages.partner_rate[small][small], 2 * 30 / 30.0, 2 * 60 / 30.0);
  check(averages.partner_rate[small][big], 24 / 30.0, 24 / 30.0);
  check(averages.partner_rate[big][small], 24 / 20.0, 24 / 20.0);
  check(averages.partner_rate[big][big], 2 * 10 / 20.0, 2 * 10 / 20.0);
  check(averages.kick_rate[small], 12 / 30.0, 12 / 30.0);
  check(averages.kick_rate[big], 8 / 20.0, 16 / 20.0);
  check(averages.injected, 10 / 50.0, 20 / 50.0);
  check(averages.dissipated, 0, 25 / 50.0);
  CHECK(averages.elastic_fraction == 0.5);
  CHECK_THROWS_AS(tally_averages(std::span(boundaries).first(1), 5, {}, {6, 4}), RunError);
}
