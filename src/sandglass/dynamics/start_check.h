// What a State must be for exact dynamics.
#pragma once

#include "sandglass/core/state.h"

namespace sandglass {

/// Throws InputError unless the state can be run exactly: at least two disks, finite numbers, centres in [0, L),
/// records not ahead of their time, L >= 8 R_max, a drive that makes sense. (Overlaps are found when lists are made.)
void check_start(const State& state);

}  // namespace sandglass
