// What is refused: states and requests that cannot be run exactly.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sandglass/core/state.h"

namespace sandglass {

/// Relative overlap 1 - distance / (R_i + R_j) up to which two disks count as touching. A running state has overlaps of
/// this origin: contact times are rounded, and centres are multiples of L * 2^-53.
inline constexpr double touching_tolerance = 1e-10;

/// The side of the box for this many disks at this area fraction.
/// Throws InputError unless there are at least two disks, the radii and the area fraction are positive and finite, and
/// the box is at least minimum_box_length(mixture) wide.
double checked_box_length(const Mixture& mixture, std::size_t small_count, std::size_t big_count,
                          double packing_fraction);

/// The worst pair of a state: relative overlap 1 - distance / (R_i + R_j), and who (first < second).
struct Overlap {
  double depth = 0;  ///< 0 where no disks overlap
  std::uint32_t first = 0, second = 0;
};

/// The deepest overlap among the centres of the records, which must lie in [0, L). Cost O(N).
Overlap deepest_overlap(const State& state);

/// Throws InputError for a start state that cannot be run exactly: radii or masses not positive, L < 8 R_b, a centre
/// that is not a number or not in [0, L), two disks that overlap by more than touching_tolerance. Looks at the centres
/// of the records: a start state has all its records at one time. Cost O(N).
void check_no_overlap(const State& state);

}  // namespace sandglass
