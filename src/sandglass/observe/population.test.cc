#include "sandglass/observe/population.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

State random_state(std::size_t n, std::uint64_t seed) {
  State state = scattered_disks(n, 40, seed);
  draw_velocities(state, 1.5);
  for (Disk& disk : state.disks) disk.vx += 3;  // a moving centre of mass
  return state;
}

}  // namespace

TEST_CASE("a snapshot is sorted by species and at rest as a whole") {
  const State state = random_state(101, 4);
  const Population population = population_of(state);
  REQUIRE(population.size() == 101);
  for (std::size_t i = 0; i < population.size(); ++i) {
    const Species expected = i < population.small_count ? small : big;
    CHECK(state.disks[population.order[i]].species == expected);
  }
  Frame frame;
  make_frame(state, frame);
  Snapshot snapshot;
  take_snapshot(frame, population, snapshot);
  double moment_x = 0, momentum_x = 0;
  for (std::size_t i = 0; i < population.size(); ++i) {
    const double mass = state.mixture.mass[i < population.small_count ? small : big];
    moment_x += mass * snapshot.x[i];
    momentum_x += mass * snapshot.vx[i];
    const std::uint32_t id = population.order[i];
    // Differences between disks are untouched, up to rounding of numbers below 100.
    CHECK(snapshot.x[i] - snapshot.x[0] == doctest::Approx(frame.x[id] - frame.x[population.order[0]]).epsilon(1e-12));
  }
  // 101 terms of order 100, each rounded to 1e-14.
  CHECK(std::fabs(moment_x) < 1e-10);
  CHECK(std::fabs(momentum_x) < 1e-11);
}

TEST_CASE("temperatures of a snapshot are those of the state") {
  const State state = random_state(77, 9);
  const Population population = population_of(state);
  Frame frame;
  make_frame(state, frame);
  Snapshot snapshot;
  take_snapshot(frame, population, snapshot);
  const Temperatures measured = temperatures(snapshot, population), expected = temperatures(state);
  CHECK(measured.all == doctest::Approx(1.5).epsilon(1e-12));
  CHECK(measured.small == doctest::Approx(expected.small).epsilon(1e-12));
  CHECK(measured.big == doctest::Approx(expected.big).epsilon(1e-12));
}

TEST_CASE("ordered_sum adds every term once, whatever the length") {
  std::vector<double> terms;
  for (int n = 0; n < 40; ++n) {
    CHECK(ordered_sum(terms) == n * (n + 1) / 2);  // whole numbers: exact in any order
    terms.push_back(n + 1);
  }
}
