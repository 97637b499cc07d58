// Hexatic order psi_6 of one frame, from the radical tessellation.
#pragma once

#include <complex>
#include <vector>

#include "sandglass/observe/population.h"

namespace sandglass {

/// psi_6 of each disk, by id: sum over neighbours j of (l_ij / sum l) e^{6 i theta_ij}, where l_ij is the length of the
/// side that the cells of i and j share and theta_ij the direction of the bond [Mickel 2013]. Cells are those of the
/// radical (power) tessellation, d^2 - R^2, which respects the two sizes of disks; weighting by length makes psi_6
/// continuous where a side vanishes (four disks on a square).
std::vector<std::complex<double>> bond_order(const Frame& frame, const Population& population);

/// |<psi_6>| over all disks: 1 in a perfect triangular lattice, about |psi_6| / sqrt(N) without long-range order.
double global_bond_order(const std::vector<std::complex<double>>& psi);

/// Mean |psi_6| of a disk.
double local_bond_order(const std::vector<std::complex<double>>& psi);

}  // namespace sandglass
