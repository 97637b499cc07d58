#include "sandglass/prepare/repeat.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/prepare/check.h"
#include "sandglass/prepare/insert.h"

using namespace sandglass;

TEST_CASE("a repeated start has the same density, no overlap, and the small disks first") {
  const State tile = insert_disks(60, 40, Mixture{}, 0.4, 3);
  const State whole = repeat_periodically(tile, 3);
  REQUIRE(whole.size() == 900);
  CHECK(whole.seed == tile.seed);
  CHECK(whole.box_length == 3 * tile.box_length);
  CHECK(packing_fraction(whole) == doctest::Approx(0.4).epsilon(1e-14));  // a few roundings
  CHECK_NOTHROW(check_no_overlap(whole));                                 // nor is any centre outside the box
  for (std::size_t id = 0; id < 900; ++id) CHECK(whole.disks[id].species == (id < 540 ? small : big));
  // The 5th copy is the one in the middle.
  CHECK(whole.disks[4 * 60 + 7].x == tile.disks[7].x + tile.box_length);
  CHECK(whole.disks[540 + 4 * 40 + 7].y == tile.disks[60 + 7].y + tile.box_length);
}

TEST_CASE("a disk at the upper border of the last tile stays inside") {
  State tile = insert_disks(50, 50, Mixture{}, 0.1, 3);
  tile.disks[0].x = std::nextafter(tile.box_length, 0.0);  // with the copies to its left it rounds up to the whole box
  const State whole = repeat_periodically(tile, 7);
  for (const Disk& disk : whole.disks) CHECK(disk.x < whole.box_length);
}

TEST_CASE("tiles have about 10^4 disks, at least 5000, and whole numbers of both species") {
  CHECK(tiles_per_side(4'000'000, 0.5) == 20);
  CHECK(tiles_per_side(1'000'000, 0.5) == 10);
  CHECK(tiles_per_side(100'000, 0.5) == 4);  // 6250; 25 000 is farther by ratio
  CHECK(tiles_per_side(22'500, 0.5) == 1);   // 5625 is odd: no half of it
  CHECK(tiles_per_side(22'500, 0.2) == 2);
  CHECK(tiles_per_side(10'000, 0.5) == 1);
  CHECK(tiles_per_side(100'002, 0.5) == 1);  // 2 * 3 * 7 * 2381 has no square
}
