// Whether a State that came from outside can be one.
#pragma once

#include <string>

#include "sandglass/core/state.h"

namespace sandglass {

inline constexpr std::size_t most_disks = std::size_t{1} << 31;

/// Checks every number of `state`: finite where it must be, sizes and masses positive, disks near the box, no time in
/// the future, each enumeration one of its names, no count near its end. (Overlaps are for the engine to refuse.)
/// Throws InputError naming `origin`, the disk and the value.
void check_state(const State& state, const std::string& origin);

}  // namespace sandglass
