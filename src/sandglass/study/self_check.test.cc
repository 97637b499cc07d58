#include "sandglass/study/self_check.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/theory/equation_of_state.h"

using namespace sandglass;

namespace {

constexpr std::size_t half = 5000;
constexpr int intervals = 5;
constexpr double interval_length = 200;

/// What a right engine would leave at packing fraction 0.5 (or 0.7), scattered by nothing. `counted` is the share of
/// the contacts that it counts, and of the virial.
Evidence evidence(double packing_fraction, double counted) {
  Evidence seen;
  seen.disks = {half, half};
  seen.packing_fraction = packing_fraction;
  seen.interval_length = interval_length;
  seen.start_energy = seen.end_energy = 2 * half;
  const double excess = fluid_compressibility_factor(seen.mixture, 0.5, 0.5) - 1;
  Tally tally;
  for (int boundary = 0; boundary <= intervals; ++boundary) {
    seen.boundaries.push_back(tally);
    tally.virial.add(counted * excess * 2 * (2 * half) * interval_length);  // Z - 1 = virial / (2 N T t)
    for (auto& contacts : tally.contacts) contacts += static_cast<std::uint64_t>(counted * 1'000'000);
  }
  for (Estimate& foretold : seen.foretold)
    foretold = {1'000'000 / interval_length, 0.004 * 1'000'000 / interval_length};
  return seen;
}

bool passes(const Evidence& seen) {
  for (const CheckedFigure& figure : check_figures(seen))
    if (!figure.passed()) return false;
  return true;
}

}  // namespace

TEST_CASE("the pressure is checked where the equation of state is exact, the collision rates elsewhere") {
  CHECK(has_equation_of_state(0.6, 1));
  CHECK(!has_equation_of_state(0.61, 1));
  CHECK(!has_equation_of_state(0.3, 0.99));
  // With the energy and the overlap.
  CHECK(check_figures(evidence(0.5, 1)).size() == 3);
  CHECK(check_figures(evidence(0.7, 1)).size() == 6);
}

TEST_CASE("an engine that misses contacts fails, one that is right passes") {
  CHECK(passes(evidence(0.5, 1)));
  CHECK(passes(evidence(0.7, 1)));
  // Z - 1 is known to 0.1 % + 1/N and 4.5 * 1.2 / sqrt(1.5e7): 0.25 %.
  CHECK(!passes(evidence(0.5, 0.99)));
  CHECK(!passes(evidence(0.5, 1.01)));
  // The sum of the rates to 0.3 % + 1/N and 4.5 * 0.4 % / sqrt(3): 1.4 %.
  CHECK(passes(evidence(0.7, 0.99)));
  CHECK(!passes(evidence(0.7, 0.98)));
  CHECK(!passes(evidence(0.7, 1.02)));
}

TEST_CASE("one wrong pair of species fails") {
  Evidence seen = evidence(0.7, 1);
  seen.foretold[2].value *= 1.03;  // known to 0.3 % + 1/N + 4.5 * 0.4 %: 2.1 %; the sum is off by 1 % only
  CHECK(!passes(seen));
}

TEST_CASE("scatter of the repeats is believed where it is large") {
  // Two intervals ahead and two behind by 4 %: a standard error of 0.04 sqrt(4 / (5 * 4)) = 1.8 %, and the mean passes
  // though it is 2 % off.
  Evidence seen = evidence(0.5, 1.02);
  CHECK(!passes(seen));
  const double lead = 0.04 * seen.boundaries[1].virial.value();
  seen.boundaries[1].virial.add(lead);
  seen.boundaries[2].virial.add(2 * lead);
  seen.boundaries[3].virial.add(lead);
  CHECK(passes(seen));
}

TEST_CASE("energy and overlap") {
  Evidence seen = evidence(0.5, 1);
  seen.end_energy *= 1 + 3e-9;
  CHECK(!passes(seen));

  seen = evidence(0.7, 1);  // driven: what came in must have gone out or be there
  seen.restitution = 0.9;
  seen.boundaries.back().injected.add(50000);
  seen.boundaries.back().dissipated.add(49000);
  seen.end_energy += 1000;
  CHECK(passes(seen));
  seen.boundaries.back().dissipated.add(1e-3);  // 2e-8 of what was turned over
  CHECK(!passes(seen));

  seen = evidence(0.5, 1);
  seen.deepest_overlap = 1e-9;
  CHECK(!passes(seen));
}

TEST_CASE("what is not a number does not pass, and failures are named") {
  Evidence seen = evidence(0.7, 1);
  seen.foretold[0].value = std::numeric_limits<double>::quiet_NaN();
  const auto figures = check_figures(seen);
  CHECK(!figures.front().passed());
  CHECK_THROWS_WITH_AS(require_passed(figures), doctest::Contains("small-small"), RunError);
  CHECK_NOTHROW(require_passed(check_figures(evidence(0.7, 1))));
}
