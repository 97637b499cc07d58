// Preparation by a quench of dissipative soft disks, for any density up to jamming.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// Soft-disk molecular dynamics [Gholami 2011, Sec. II]: disks with a linear repulsive spring and a dashpot (see
/// SoftDisks) start at random positions, are compressed to the area fraction `jammed_fraction`, come to rest there, and
/// are expanded to `packing_fraction`. "At rest": the largest overlap is at most 0.5 % of the contact distance, and at
/// most half of what the expansion removes (0.6 % from 0.84 to 0.82). Up to 0.823 a seed thus gives the same packing,
/// only wider. Few disks (N < 23) stop at a box of 7 R_b instead. Packings of very few disks may jam below
/// `jammed_fraction`: then the next attempt starts from fresh random positions, random_words(seed, positions, id,
/// attempt). Equal disks (size_ratio = 1) crystallise, as they must at this density.
/// Throws InputError for what checked_box_length refuses and unless packing_fraction < jammed_fraction <= 0.9; RunError
/// if all attempts jammed.
State quench_disks(std::size_t small_count, std::size_t big_count, const Mixture& mixture, double packing_fraction,
                   std::uint64_t seed, double jammed_fraction = 0.84, const Progress& progress = {});

}  // namespace sandglass
