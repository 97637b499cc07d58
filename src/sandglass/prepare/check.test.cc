#include "sandglass/prepare/check.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <string>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"
#include "sandglass/prepare/periodic.h"

using namespace sandglass;

namespace {

State random_points(std::size_t count, double box_length, std::uint64_t seed) {
  State state;
  state.box_length = box_length;
  state.disks.resize(count);
  for (std::size_t id = 0; id < count; ++id) {
    const auto words = random_words(seed, Stream::positions, id, 0);
    state.disks[id].x = wrapped(box_length * uniform(words[0]), box_length);
    state.disks[id].y = wrapped(box_length * uniform(words[1]), box_length);
    state.disks[id].species = words[2] % 2 ? big : small;
  }
  return state;
}

double deepest_of_all_pairs(const State& state) {
  double deepest = 0;
  for (std::size_t i = 0; i < state.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Disk &a = state.disks[i], &b = state.disks[j];
      const double dx = nearest_image(a.x - b.x, state.box_length), dy = nearest_image(a.y - b.y, state.box_length);
      const double contact = state.mixture.radius[a.species] + state.mixture.radius[b.species];
      deepest = std::max(deepest, 1 - std::sqrt(dx * dx + dy * dy) / contact);
    }
  }
  return deepest;
}

std::string complaint(const State& state) {
  try {
    check_no_overlap(state);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

State two_disks(double distance) {
  State state;
  state.box_length = 20;
  state.disks.resize(2);
  state.disks[0].x = 0.5, state.disks[0].y = 7;
  state.disks[1].x = 20.5 - distance, state.disks[1].y = 7;  // across the border
  return state;
}

}  // namespace

TEST_CASE("the deepest overlap is that of all pairs, in boxes of one cell and of many") {
  // Both sides do the same operations on the same pairs, up to the sign of the difference: equal bits.
  CHECK(rc::check([] {
    const auto count = *rc::gen::inRange<std::size_t>(2, 120);
    const double box_length = 1 + 0.1 * *rc::gen::inRange(0, 800);
    const State state = random_points(count, box_length, *rc::gen::arbitrary<std::uint32_t>());
    RC_ASSERT(deepest_overlap(state).depth == deepest_of_all_pairs(state));
  }));
}

TEST_CASE("an overlap across the border is refused and named, a touch is not") {
  CHECK(complaint(two_disks(2)).empty());
  CHECK(complaint(two_disks(2 * (1 - 0.9 * touching_tolerance))).empty());
  CHECK_FALSE(complaint(two_disks(2 * (1 - 1.1 * touching_tolerance))).empty());
  CHECK(complaint(two_disks(1.9)).find("disks 0 and 1 overlap by 0.05") == 0);
}

TEST_CASE("states that no run can start from are refused") {
  State state = two_disks(3);
  REQUIRE(complaint(state).empty());
  SUBCASE("not a number") { state.disks[1].y = std::numeric_limits<double>::quiet_NaN(); }
  SUBCASE("on the far border") { state.disks[1].y = 20; }
  SUBCASE("negative") { state.disks[0].x = -1e-9; }
  SUBCASE("box too small") { state.box_length = 8 * 1.43 - 0.01; }
  SUBCASE("box not finite") { state.box_length = std::numeric_limits<double>::infinity(); }
  SUBCASE("radius zero") { state.mixture.radius[small] = 0; }
  SUBCASE("mass negative") { state.mixture.mass[big] = -1; }
  CHECK_FALSE(complaint(state).empty());
}

TEST_CASE("requests that no box fits are refused") {
  const Mixture mixture;
  CHECK(checked_box_length(mixture, 50, 50, 0.5) == box_length_for(mixture, 50, 50, 0.5));
  CHECK_THROWS_AS(checked_box_length(mixture, 1, 0, 0.01), InputError);
  CHECK_THROWS_AS(checked_box_length(mixture, 50, 50, 0), InputError);
  CHECK_THROWS_AS(checked_box_length(mixture, 50, 50, std::numeric_limits<double>::quiet_NaN()), InputError);
  CHECK_THROWS_AS(checked_box_length(mixture, 5, 5, 0.4), InputError);  // 10.9 wide, 11.44 needed
}
