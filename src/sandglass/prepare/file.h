// Preparation from a stored state, usually another run's aged one.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sandglass/core/state.h"

namespace sandglass {

/// The centres of `loaded` at its own time, scaled with the box to `packing_fraction`, as a fresh start with `seed`:
/// disks at rest at time 0, small ones first and otherwise in the order of `loaded`. A lower area fraction is always
/// possible, a higher one as far as no disks overlap.
/// Throws InputError if the numbers of disks or the radii are not those asked for, if `loaded` is no valid start (see
/// check_no_overlap), or if the area fraction is out of reach (the message names the greatest one).
State adapt_state(const State& loaded, std::size_t small_count, std::size_t big_count, const Mixture& mixture,
                  double packing_fraction, std::uint64_t seed);

}  // namespace sandglass
