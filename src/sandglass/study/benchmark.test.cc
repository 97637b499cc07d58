#include "sandglass/study/benchmark.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/core/errors.h"

using namespace sandglass;

namespace {

BenchmarkPlan small_plan(double packing_fraction) {
  BenchmarkPlan plan;
  plan.config.system.particles = 200;
  plan.config.system.packing_fraction = packing_fraction;
  plan.config.prepare.method = packing_fraction > 0.45 ? PrepareMethod::quench : PrepareMethod::insert;
  plan.config.collision.restitution = 1;
  plan.config.drive.kind = DriveKind::none;
  plan.age = 20;
  plan.collisions = 200;
  plan.repeats = 3;
  return plan;
}

}  // namespace

TEST_CASE("a benchmark measures what was asked, and its disks are hard disks") {
  for (const double eta : {0.3, 0.7}) {  // by the equation of state, by the frames
    CAPTURE(eta);
    const Benchmark result = run_benchmark(small_plan(eta));
    CHECK_NOTHROW(require_passed(result.check));
    CHECK(result.rates.size() == 3);
    CHECK(result.tiles_per_side == 1);
    // Ageing ends at a beat, one collision per disk or so; the rate found in ten collisions per disk is good to
    // 1.2 / sqrt(1000) = 4 %, and so is the one after it in the measured 200.
    CHECK(result.aged == doctest::Approx(20.5).epsilon(0.1));
    CHECK(result.measured == doctest::Approx(200).epsilon(0.2));
    CHECK(result.temperature == doctest::Approx(1).epsilon(1e-9));
    const auto timed = static_cast<std::uint64_t>(std::llround(result.measured * 100));
    if (eta == 0.3)  // no frames: all of the measured stretch is timed
      CHECK(result.events.collisions() == timed);
    else
      CHECK(result.events.collisions() > timed);
    CHECK(result.bookkeeping.predictions > result.events.collisions());
    CHECK(result.bytes_per_disk > 0);
  }
}

TEST_CASE("the state at the end depends on the plan alone") {
  const std::string hash = run_benchmark(small_plan(0.7)).state_hash;
  CHECK(run_benchmark(small_plan(0.7)).state_hash == hash);
  BenchmarkPlan other = small_plan(0.7);
  other.config.run.seed = 2;
  CHECK(run_benchmark(other).state_hash != hash);
}

TEST_CASE("a large start is made of tiles") {
  BenchmarkPlan plan = small_plan(0.4);
  plan.config.system.particles = 20'400;  // 2 x 2 tiles of 5100, nearer to 10^4 than the whole
  plan.age = 5;
  plan.collisions = 5;
  const Benchmark result = run_benchmark(plan);
  CHECK(result.tiles_per_side == 2);
  // Random insertion is not an equilibrium fluid, and five collisions per disk do not make it one: of the pressure
  // nothing can be said here, but the disks must be apart and keep their energy.
  for (std::size_t i = 1; i < result.check.size(); ++i) CHECK(result.check[i].passed());
}

TEST_CASE("driven disks come out at the temperature wanted, and are checked") {
  BenchmarkPlan plan = small_plan(0.6);
  plan.config.collision.restitution = 0.8;
  plan.config.drive.kind = DriveKind::pair;
  const Benchmark result = run_benchmark(plan);
  CHECK_NOTHROW(require_passed(result.check));
  CHECK(result.kick_frequency > 0);
  // One frame of 200 disks: T scatters by 1/sqrt(200) = 7 %, times 4.5.
  CHECK(result.temperature == doctest::Approx(1).epsilon(0.32));
  // One pair kick for each collision, by the calibrated frequency: 3 % of 1.5e4 or so, and what T is off.
  const auto ratio = static_cast<double>(result.events.kicks) / static_cast<double>(result.events.collisions());
  CHECK(ratio == doctest::Approx(1).epsilon(0.15));
}

TEST_CASE("what is no benchmark is refused") {
  BenchmarkPlan plan = small_plan(0.3);
  plan.config.collision.restitution = 0.9;
  CHECK_THROWS_WITH_AS(run_benchmark(plan), doctest::Contains("cool"), InputError);
  plan = small_plan(0.3);
  plan.config.drive.kind = DriveKind::pair;
  CHECK_THROWS_WITH_AS(run_benchmark(plan), doctest::Contains("steady"), InputError);
  plan.config.collision.restitution = 0.4;
  CHECK_THROWS_WITH_AS(run_benchmark(plan), doctest::Contains("self-check"), InputError);
  plan = small_plan(0.3);
  plan.age = 1;
  CHECK_THROWS_WITH_AS(run_benchmark(plan), doctest::Contains("age"), InputError);
  plan = small_plan(0.3);
  plan.repeats = 0;
  CHECK_THROWS_WITH_AS(run_benchmark(plan), doctest::Contains("repeat"), InputError);
}

TEST_CASE("the default length") {
  CHECK(default_collisions(10'000) == 4000);
  CHECK(default_collisions(4'000'000) == 10);
  CHECK(default_collisions(20'000'000) == 5);
}
