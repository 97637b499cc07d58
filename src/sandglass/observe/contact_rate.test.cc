#include "sandglass/observe/contact_rate.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

// Points that know nothing of each other: any two pass the distance r of each other at a rate that follows by hand.
State ideal_gas(std::size_t n, std::uint64_t seed) {
  State state = scattered_disks(n, 100, seed);
  draw_velocities(state, 2);
  return state;
}

}  // namespace

TEST_CASE("points that know nothing of each other would collide as often as kinetic theory says") {
  const std::size_t n = 900;
  const State first = ideal_gas(n, 1);
  ContactRate rate(population_of(first), 0.12);
  Frame frame;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    make_frame(ideal_gas(n, seed), frame);
    rate.add(frame);
  }
  const double ns = 600, nb = 300, area = 1e4;
  const auto expected = [&](double pairs, int i, int j) {
    const auto& [radius, mass] = first.mixture;
    const double speed = std::sqrt(2 * 2 * (1 / mass[i] + 1 / mass[j]) / std::numbers::pi);
    return pairs / area * 2 * std::numbers::pi * (radius[i] + radius[j]) * speed / 2;
  };
  const double rates[] = {expected(ns * (ns - 1) / 2, 0, 0), expected(ns * nb, 0, 1),
                          expected(nb * (nb - 1) / 2, 1, 1)};
  for (std::size_t pair = 0; pair < 3; ++pair) {
    const Estimate found = rate.collisions_per_time(pair);
    CAPTURE(pair);
    CHECK(found.error < 0.05 * rates[pair]);  // else the check below would be idle
    // 4.5 sigma; the parabola is exact here (J is proportional to r), T is exact to 1/N.
    CHECK(std::fabs(found.value - rates[pair]) < 4.5 * found.error + rates[pair] / n);
  }
}

TEST_CASE("two disks by hand") {
  State state;
  state.box_length = 50;
  state.disks.resize(2);
  state.disks[0].x = 49, state.disks[1].x = 1.05;  // a gap of 0.05 across the border: 0.025 contact distances
  state.disks[1].vx = -3;
  Frame frame;
  make_frame(state, frame);
  ContactRate rate(population_of(state), 0.08);
  rate.add(frame);
  // |dr/dt| / 2 over the width of a bin, 0.02 R_s; the third of eight bins is at u = -3/2, where the parabola's edge
  // value takes the weight 6/42 + (86 * 9/4 - 567/2) / 1344 = 17/224.
  CHECK(rate.collisions_per_time(0).value == doctest::Approx(3.0 / 2 / 0.02 * 17 / 224).epsilon(1e-9));
  CHECK(rate.collisions_per_time(1).value == 0);
  CHECK(rate.collisions_per_time(2).value == 0);
}
