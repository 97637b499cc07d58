#include "sandglass/prepare/file.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sandglass/core/errors.h"
#include "sandglass/prepare/check.h"
#include "sandglass/prepare/insert.h"
#include "sandglass/prepare/periodic.h"

using namespace sandglass;

namespace {

State loaded_state(double packing_fraction, std::uint64_t seed) {
  return insert_disks(60, 40, Mixture{}, packing_fraction, seed);
}

}  // namespace

TEST_CASE("a stored state can always be expanded, the disks keeping their relative places") {
  CHECK(rc::check([] {
    const State loaded = loaded_state(0.4, *rc::gen::arbitrary<std::uint32_t>());
    const double eta = 0.01 * *rc::gen::inRange(1, 41);
    const State state = adapt_state(loaded, 60, 40, Mixture{}, eta, 7);
    check_no_overlap(state);
    RC_ASSERT(std::fabs(packing_fraction(state) / eta - 1) < 10 * 0x1p-53);
    RC_ASSERT(state.seed == 7u);
    for (std::size_t id = 0; id < state.size(); ++id) {
      RC_ASSERT(state.disks[id].species == loaded.disks[id].species);
      // Three roundings.
      RC_ASSERT(std::fabs(state.disks[id].x / state.box_length - loaded.disks[id].x / loaded.box_length) < 4 * 0x1p-53);
    }
  }));
}

TEST_CASE("compression goes exactly as far as the message says") {
  CHECK(rc::check([] {
    const State loaded = loaded_state(0.3, *rc::gen::arbitrary<std::uint32_t>());
    std::string message;
    try {
      adapt_state(loaded, 60, 40, Mixture{}, 0.7, 1);  // no packing left by insertion at 0.3 can do that
    } catch (const InputError& error) {
      message = error.what();
    }
    const std::string before = "disks would overlap above ";
    const auto at = message.find(before);
    RC_ASSERT(at != std::string::npos);
    const double greatest = std::stod(message.substr(at + before.size()));
    RC_ASSERT(greatest >= 0.299999);
    RC_ASSERT(deepest_overlap(adapt_state(loaded, 60, 40, Mixture{}, greatest, 1)).depth <= touching_tolerance);
    RC_ASSERT_THROWS_AS(adapt_state(loaded, 60, 40, Mixture{}, greatest + 2e-6, 1), InputError);
  }));
}

TEST_CASE("a running state is taken at its own time, at rest, with the small disks first") {
  State loaded = loaded_state(0.2, 3);
  std::reverse(loaded.disks.begin(), loaded.disks.end());  // the big ones first
  const State still = adapt_state(loaded, 60, 40, Mixture{}, 0.2, 1);
  loaded.now = 5;
  for (Disk& disk : loaded.disks) {
    // Each record is older by 3 and lies three flights of 0.9 L back: outside the box, as records may.
    disk.time = 2;
    disk.vx = 0.3 * loaded.box_length, disk.vy = -disk.vx;
    disk.x -= 0.9 * loaded.box_length, disk.y += 0.9 * loaded.box_length;
    disk.image_x = 5, disk.kick_count = 9, disk.last_contact = 1;
  }
  const State moved = adapt_state(loaded, 60, 40, Mixture{}, 0.2, 1);
  for (std::size_t id = 0; id < moved.size(); ++id) {
    const Disk &a = moved.disks[id], &b = still.disks[id];
    CHECK(a.species == (id < 60 ? small : big));
    CHECK((a.vx == 0 && a.vy == 0 && a.time == 0 && a.image_x == 0 && a.kick_count == 0));
    CHECK(a.last_contact == b.last_contact);
    // Coordinates up to 2 L = 110, some five roundings of 2^-53 each.
    CHECK(std::fabs(nearest_image(a.x - b.x, moved.box_length)) < 1e-13);
    CHECK(std::fabs(nearest_image(a.y - b.y, moved.box_length)) < 1e-13);
  }
  CHECK(moved.now == 0);
}

TEST_CASE("stored states of another make are refused") {
  const State loaded = loaded_state(0.3, 5);
  CHECK_NOTHROW(adapt_state(loaded, 60, 40, Mixture{}, 0.3, 1));
  CHECK_THROWS_AS(adapt_state(loaded, 40, 60, Mixture{}, 0.3, 1), InputError);
  CHECK_THROWS_AS(adapt_state(loaded, 60, 41, Mixture{}, 0.3, 1), InputError);
  CHECK_THROWS_AS(adapt_state(loaded, 60, 40, (Mixture{{1, 1.4}, {1, 1.96}}), 0.3, 1), InputError);
  CHECK_THROWS_AS(adapt_state(loaded, 60, 40, Mixture{}, -0.3, 1), InputError);
  State overlapping = loaded;
  overlapping.disks[7].x = overlapping.disks[8].x, overlapping.disks[7].y = overlapping.disks[8].y;
  CHECK_THROWS_AS(adapt_state(overlapping, 60, 40, Mixture{}, 0.01, 1), InputError);
}
