#include "sandglass/prepare/insert.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/periodic.h"

using namespace sandglass;

namespace {

Mixture mixture_of(double size_ratio) { return {{1, size_ratio}, {1, size_ratio * size_ratio}}; }

}  // namespace

TEST_CASE("insertion: valid starts of the exact area fraction, small disks first") {
  CHECK(rc::check([] {
    const Mixture mixture = mixture_of(1 + 0.01 * *rc::gen::inRange(0, 101));
    const auto small_count = *rc::gen::inRange<std::size_t>(30, 400),
               big_count = *rc::gen::inRange<std::size_t>(30, 400);
    const double eta = 0.01 * *rc::gen::inRange(1, 46);
    const State state = insert_disks(small_count, big_count, mixture, eta, *rc::gen::arbitrary<std::uint32_t>());
    check_no_overlap(state);
    RC_ASSERT(deepest_overlap(state).depth == 0);
    RC_ASSERT(std::fabs(packing_fraction(state) / eta - 1) < 10 * 0x1p-53);
    RC_ASSERT(state.size() == small_count + big_count);
    for (std::size_t id = 0; id < state.size(); ++id) {
      const Disk& disk = state.disks[id];
      RC_ASSERT(disk.species == (id < small_count ? small : big));
      RC_ASSERT(disk.vx == 0 && disk.vy == 0 && disk.time == 0 && disk.image_x == 0 && disk.image_y == 0);
    }
  }));
}

TEST_CASE("insertion refuses what it cannot reach") {
  CHECK_NOTHROW(insert_disks(200, 200, Mixture{}, 0.45, 1));
  CHECK_THROWS_AS(insert_disks(200, 200, Mixture{}, 0.46, 1), InputError);
  CHECK_THROWS_AS(insert_disks(5, 5, Mixture{}, 0.45, 1), InputError);
  CHECK_THROWS_AS(insert_disks(200, 200, mixture_of(-1), 0.2, 1), InputError);
}

TEST_CASE("insertion: the seed decides, and ids say nothing about places") {
  constexpr std::size_t count = 2000;
  const State first = insert_disks(count / 2, count / 2, Mixture{}, 0.3, 1);
  CHECK(state_hash(first) == state_hash(insert_disks(count / 2, count / 2, Mixture{}, 0.3, 1)));
  const State second = insert_disks(count / 2, count / 2, Mixture{}, 0.3, 2);
  // The distance between two independent uniform points of a periodic unit square has mean (sqrt 2 + ln(1 + sqrt 2)) /
  // 6 = 0.38260 and variance 1/6 - mean^2 = 0.0203. Over 2000 pairs: sigma = 0.0032; 5 sigma, false alarm 6e-7 each.
  double along_ids = 0, across_seeds = 0;
  for (std::size_t id = 0; id < count; ++id) {
    const auto distance = [](const State& a, const Disk& p, const Disk& q) {
      const double dx = nearest_image(p.x - q.x, a.box_length), dy = nearest_image(p.y - q.y, a.box_length);
      return std::sqrt(dx * dx + dy * dy) / a.box_length;
    };
    along_ids += distance(first, first.disks[id], first.disks[(id + 1) % count]) / count;
    across_seeds += distance(first, first.disks[id], second.disks[id]) / count;
  }
  CHECK(std::fabs(along_ids - 0.3826) < 5 * 0.0032);
  CHECK(std::fabs(across_seeds - 0.3826) < 5 * 0.0032);
}
