#include "sandglass/prepare/expand.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

using namespace sandglass;

TEST_CASE("expansion gives the exact area fraction and keeps all centres in the box, in proportion") {
  CHECK(rc::check([] {
    State state;
    state.box_length = 1 + 1e-3 * *rc::gen::inRange(0, 1000000);
    const double old_length = state.box_length;
    state.disks.resize(4);
    const double fractions[] = {0, 1e-3 * *rc::gen::inRange(0, 1000), 0.5, 1 - 0x1p-53};
    for (std::size_t id = 0; id < 4; ++id) {
      state.disks[id].x = fractions[id] * old_length, state.disks[id].y = fractions[3 - id] * old_length;
      state.disks[id].species = id < 2 ? small : big;
    }
    const double target = 1e-3 * *rc::gen::inRange(1, 900);
    const State before = state;
    expand(state, target);
    // Square root, quotient, square and products: fewer than ten roundings of 2^-53.
    RC_ASSERT(std::fabs(packing_fraction(state) / target - 1) < 10 * 0x1p-53);
    for (std::size_t id = 0; id < 4; ++id) {
      RC_ASSERT(state.disks[id].x >= 0 && state.disks[id].x < state.box_length);
      RC_ASSERT(state.disks[id].y >= 0 && state.disks[id].y < state.box_length);
      // Two roundings, or the step from L to 0.
      const double error = std::fabs(state.disks[id].x / state.box_length - before.disks[id].x / old_length);
      RC_ASSERT(error < 4 * 0x1p-53 || state.disks[id].x == 0);
    }
  }));
}
