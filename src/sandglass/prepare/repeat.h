// A large start out of a small one, repeated periodically.
#pragma once

#include <cstddef>

#include "sandglass/core/state.h"

namespace sandglass {

/// `per_side` x `per_side` copies of `tile` side by side in a box as many times as wide: the same law, drive, seed and
/// area fraction; small disks first, each species copy after copy, each copy in the order of its ids. Copies move alike
/// until every disk gets a velocity (and a kick clock) of its own: draw_velocities, start_kick_clocks. Preparing a
/// large start disk by disk takes much longer; what a periodic start cannot have is structure wider than its tile.
/// \pre tile is a start state: all its records at one time
State repeat_periodically(const State& tile, std::size_t per_side);

/// Copies per side by which `particles` disks are best made of equal square tiles of about 10^4 disks: the tile is
/// nearest to that by ratio, has at least 5000 disks, and `tile * big_fraction` is a whole number. 1 where the number
/// has no such divisor, or is small.
std::size_t tiles_per_side(std::size_t particles, double big_fraction);

}  // namespace sandglass
