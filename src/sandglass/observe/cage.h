// Motion relative to the cage of neighbours, which long-wavelength fluctuations do not inflate.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Greatest distance of a neighbour, in contact distances R_i + R_j: about the first minimum of g(r) in dense fluids.
inline constexpr double neighbour_reach = 1.5;

/// The neighbours that each disk has at one moment, in the order of the population: those of disk i are `neighbour`
/// from first[i] to first[i + 1]. About 30 bytes per disk at high density.
struct Cages {
  std::vector<std::uint32_t> first, neighbour;
};
Cages cages_of(const Snapshot& snapshot, const Population& population);

/// Displacement of each disk minus the mean displacement of its neighbours at the origin [Mazoyer 2009]; that of
/// a disk without neighbours is left as it is.
struct RelativeDisplacements {
  std::vector<double> x, y;
};
RelativeDisplacements relative_displacements(const Snapshot& origin, const Snapshot& now, const Cages& cages);

/// Adds sum_i (s |dr_i|)^2 over the disks of `range`; `scale` s as in add_displacements.
void add_squares(const RelativeDisplacements& displacements, Range range, double scale, ExactSum& square);

}  // namespace sandglass
