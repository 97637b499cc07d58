// Preparation by random sequential insertion, for low densities.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// Above this area fraction insertion is refused: the chance to find a hole falls steeply towards saturation (0.547 for
/// equal disks [Feder 1980]).
inline constexpr double insert_limit = 0.45;

/// Random sequential insertion: the big disks, then the small ones, each at the first of its uniformly distributed
/// trial positions that overlaps no disk already there. Disk `id` draws from random_words(seed, positions, id, trial).
/// Throws InputError above insert_limit and for what checked_box_length refuses; RunError if a disk finds no place.
State insert_disks(std::size_t small_count, std::size_t big_count, const Mixture& mixture, double packing_fraction,
                   std::uint64_t seed, const Progress& progress = {});

}  // namespace sandglass
