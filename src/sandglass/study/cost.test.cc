#include "sandglass/study/cost.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace sandglass;

namespace {

Config config_at(double packing_fraction, std::uint64_t particles = 10000, double collisions = 10000) {
  Config config;
  config.system.packing_fraction = packing_fraction;
  config.system.particles = particles;
  config.run.collisions = collisions;
  return config;
}

}  // namespace

TEST_CASE("the expected time is that of bench/RESULTS.md, longer with length and more than so with size") {
  // 2.3 million driven collisions per second were measured at 10^4 disks and 0.8: 5 * 10^9 of them, and little else.
  CHECK(reference_seconds(config_at(0.8, 10000, 1e6)) == doctest::Approx(5e9 / 2.3e6).epsilon(0.05));
  const double one = reference_seconds(config_at(0.7));
  CHECK(reference_seconds(config_at(0.7, 10000, 20000)) > 1.5 * one);
  CHECK(reference_seconds(config_at(0.7, 100000)) > 10 * one);
  // Between the points of the table, and beyond them.
  double before = reference_seconds(config_at(0.001));
  for (double eta = 0.01; eta < 0.78; eta += 0.03) {
    const double next = reference_seconds(config_at(eta));
    CHECK(next <= before);
    before = next;
  }
}

TEST_CASE("a pace is interpolated between the densities that were probed") {
  const Pace pace{{{0.3, {1, 1, 1, 1}}, {0.7, {2, 2, 2, 2}}}, 1};
  const auto factor = [&](double eta) { return pace.seconds(config_at(eta)) / reference_seconds(config_at(eta)); };
  CHECK(factor(0.1) == doctest::Approx(1));
  CHECK(factor(0.5) == doctest::Approx(1.5));
  CHECK(factor(0.8) == doctest::Approx(2));
}

TEST_CASE("what large systems take beyond the table counts for them alone, and for collisions alone") {
  const Pace pace{{{0.5, {}}}, 2};
  const auto factor = [&](std::uint64_t particles) {
    const Config config = config_at(0.5, particles);
    return pace.seconds(config) / reference_seconds(config);
  };
  CHECK(factor(1000) == doctest::Approx(1));
  CHECK(factor(10000) == doctest::Approx(1));
  CHECK(factor(1000000) == doctest::Approx(2).epsilon(0.05));  // little else than collisions
  CHECK(factor(1000000) < 2);
  CHECK(factor(40000) > 1.3);
  CHECK(factor(40000) < 1.6);
}

TEST_CASE(
    "a probe measures every kind of point that can be run, large or small, and leaves out what it cannot prepare") {
  std::vector<Config> configs{config_at(0.2, 200, 30), config_at(0.6, 1000000), config_at(0.8)};
  configs[0].drive.kind = DriveKind::none;
  configs[1].prepare.method = PrepareMethod::file;
  configs[1].prepare.file = "/absent";
  configs[1].system.big_fraction = 0.3;
  const Pace pace = probe_pace(configs);
  REQUIRE(pace.factors.size() == 3);
  for (const auto& [eta, factor] : pace.factors)
    for (const double part : {factor.preparing, factor.collision, factor.comparison, factor.structure}) {
      CHECK(part > 0);  // how large depends on the machine and on how it was built
      CHECK(std::isfinite(part));
    }
  CHECK(pace.large > 0);
  CHECK(probe_pace({}).seconds(configs[2]) == reference_seconds(configs[2]));
}

TEST_CASE("room on the disk grows with disks, frames and intervals") {
  Config config = config_at(0.7);
  const double bytes = expected_bytes(config);
  // 10^4 disks, 10 intervals, 11 frames: 2 * 2.5 MB of checkpoints, 4.6 MB of frames, 0.5 MB of report were measured.
  CHECK(bytes == doctest::Approx(10.2e6).epsilon(0.1));
  config.output.trajectory_frames = 111;
  CHECK(expected_bytes(config) == doctest::Approx(bytes + 40e6).epsilon(0.01));
  config.run.intervals = 1000;
  CHECK(expected_bytes(config) > bytes + 40e6);
}
