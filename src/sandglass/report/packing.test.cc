#include "sandglass/report/packing.h"

#include <doctest/doctest.h>

#include "sandglass/report/synthetic_run.test.h"

namespace sandglass {

TEST_CASE("a packing that can be seen is shown whole, wrapped into the box") {
  State state = synthetic_state(100);
  state.disks[3].x -= 7 * state.box_length;  // an unwrapped record, as it may stand between transits
  state.disks[3].image_x = 2;
  const Packing packing = packing_of(state);
  REQUIRE(packing.x.size() == 100);
  CHECK(packing.side == state.box_length);
  CHECK(packing.left == 0);
  for (std::size_t i = 0; i < 100; ++i) {
    CHECK(packing.x[i] >= 0);
    CHECK(packing.x[i] < state.box_length);
    CHECK(packing.species[i] == state.disks[packing.id[i]].species);
    CHECK(std::abs(packing.psi[i]) <= 1);
  }
  // Two additions and a floor of numbers below 10 L: a few units in the last place of 10 L = 245.
  CHECK(packing.x[3] == doctest::Approx(synthetic_state(100).disks[3].x).epsilon(1e-12));
}

TEST_CASE("each disk has its bond order, whatever part of the box is shown") {
  State state;  // a triangular lattice of 24 rows of 20, squeezed by 4 % into the square: close to psi_6 = 1
  state.box_length = 60;
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 20; ++column)
      state.disks.push_back({.x = 3 * (column + 0.5 * (row % 2)), .y = 2.5 * row});
  const Packing whole = packing_of(state), middle = packing_of(state, 120);
  REQUIRE(middle.psi.size() == middle.id.size());
  REQUIRE(middle.id.size() < 200);
  for (std::size_t i = 0; i < middle.id.size(); ++i) {
    CHECK(middle.psi[i] == whole.psi[middle.id[i]]);
    CHECK(middle.psi[i].real() > 0.9);
  }
}

TEST_CASE("of a larger one the middle is shown") {
  const State state = synthetic_state(10000);
  const Packing packing = packing_of(state, 2500);
  CHECK(packing.side == doctest::Approx(state.box_length / 2));
  CHECK(packing.left == doctest::Approx(state.box_length / 4));
  // The grid has 100 columns; the middle half of them is 50, plus or minus the one at each border.
  CHECK(packing.x.size() >= 49 * 49);
  CHECK(packing.x.size() <= 51 * 51);
  for (std::size_t i = 0; i < packing.x.size(); ++i) {
    CHECK(packing.x[i] >= packing.left);
    CHECK(packing.y[i] < packing.bottom + packing.side);
  }
}

}  // namespace sandglass
