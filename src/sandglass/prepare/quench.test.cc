#include "sandglass/prepare/quench.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/periodic.h"

using namespace sandglass;

namespace {

Mixture mixture_of(double size_ratio) { return {{1, size_ratio}, {1, size_ratio * size_ratio}}; }

void check_packing(const State& state, std::size_t small_count, double eta) {
  check_no_overlap(state);
  RC_ASSERT(deepest_overlap(state).depth == 0);
  RC_ASSERT(std::fabs(packing_fraction(state) / eta - 1) < 10 * 0x1p-53);
  for (std::size_t id = 0; id < state.size(); ++id) {
    const Disk& disk = state.disks[id];
    RC_ASSERT(disk.species == (id < small_count ? small : big));
    RC_ASSERT(disk.vx == 0 && disk.vy == 0 && disk.time == 0);
  }
}

}  // namespace

TEST_CASE("quench: no overlap and the exact area fraction for any seed, size, size ratio and density") {
  CHECK(rc::check([] {
    const double ratio = 1 + 0.01 * *rc::gen::inRange(0, 101), eta = 0.01 * *rc::gen::inRange(1, 83);
    // Half of the disks are small; from 60 disks on (not in tiny boxes) every packing comes to rest.
    const auto half = *rc::gen::inRange<std::size_t>(30, 300);
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    check_packing(quench_disks(half, half, mixture_of(ratio), eta, seed), half, eta);
  }));
}

TEST_CASE("quench: boxes just above the least width, down to two disks") {
  CHECK(rc::check([] {
    const auto half = *rc::gen::inRange<std::size_t>(1, 13);
    const Mixture mixture;
    // The area fraction of these disks in a box of 8 R_b, or 0.82 if that is less.
    const double unit_length = box_length_for(mixture, half, half, 1), least = minimum_box_length(mixture);
    const double eta = std::min(0.82, unit_length * unit_length / (least * least));
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    check_packing(quench_disks(half, half, mixture, eta, seed), half, eta);
  }));
}

TEST_CASE("quench: 2000 disks of unequal numbers at the greatest density") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const State state = quench_disks(1500, 500, Mixture{}, 0.82, seed);
    check_no_overlap(state);
    CHECK(deepest_overlap(state).depth == 0);
  }
}

TEST_CASE("quench: the seed decides, and ids say nothing about places") {
  constexpr std::size_t count = 2000;
  const State first = quench_disks(count / 2, count / 2, Mixture{}, 0.8, 1);
  CHECK(state_hash(first) == state_hash(quench_disks(count / 2, count / 2, Mixture{}, 0.8, 1)));
  const State second = quench_disks(count / 2, count / 2, Mixture{}, 0.8, 2);
  // As for insertion: mean 0.38260, variance 0.0203, 2000 pairs. Ids are thrown in independently; those disks that are
  // neighbours can only lower the number of independent pairs by correlations of a few disks: 8 sigma covers that.
  double along_ids = 0, across_seeds = 0;
  for (std::size_t id = 0; id < count; ++id) {
    const auto distance = [&](const Disk& p, const Disk& q) {
      const double dx = nearest_image(p.x - q.x, first.box_length), dy = nearest_image(p.y - q.y, first.box_length);
      return std::sqrt(dx * dx + dy * dy) / first.box_length;
    };
    along_ids += distance(first.disks[id], first.disks[(id + 1) % count]) / count;
    across_seeds += distance(first.disks[id], second.disks[id]) / count;
  }
  CHECK(std::fabs(along_ids - 0.3826) < 8 * 0.0032);
  CHECK(std::fabs(across_seeds - 0.3826) < 8 * 0.0032);
}

TEST_CASE("quench: one seed gives one packing at every density up to 0.82") {
  const State dense = quench_disks(200, 200, Mixture{}, 0.82, 9), thin = quench_disks(200, 200, Mixture{}, 0.05, 9);
  for (std::size_t id = 0; id < dense.size(); ++id) {
    // Two roundings on either side.
    CHECK(std::fabs(dense.disks[id].x / dense.box_length - thin.disks[id].x / thin.box_length) < 8 * 0x1p-53);
  }
}

TEST_CASE("quench: these bits on every machine") {
  // A thousand chaotic steps turn any difference in one rounding into another packing.
  const State state = quench_disks(100, 100, Mixture{}, 0.8, 1);
  CHECK(state.disks[17].x == 0x1.0150ca52a446p+5);
  CHECK(state.disks[17].y == 0x1.d83e02145060ap+4);
}

TEST_CASE("quench refuses what it cannot reach") {
  CHECK_THROWS_AS(quench_disks(100, 100, Mixture{}, 0.84, 1), InputError);
  CHECK_THROWS_AS(quench_disks(100, 100, Mixture{}, 0.5, 1, 0.4), InputError);
  CHECK_THROWS_AS(quench_disks(100, 100, Mixture{}, 0.5, 1, 0.95), InputError);
  CHECK_THROWS_AS(quench_disks(5, 5, Mixture{}, 0.8, 1), InputError);
  // A mixture jams near 0.84: at 0.88 no attempt can come to rest, and the run says so.
  CHECK_THROWS_AS(quench_disks(500, 500, Mixture{}, 0.8, 1, 0.88), RunError);
}
