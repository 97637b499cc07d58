// An order of the disks in memory in which neighbours in space are mostly neighbours in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/state.h"

namespace sandglass {

/// Ids along a Hilbert curve through the box, at cells about one disk wide. Changes no bit of a trajectory.
std::vector<std::uint32_t> spatial_order(const State& state);

}  // namespace sandglass
