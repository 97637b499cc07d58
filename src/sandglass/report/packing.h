// The picture of a packing: centres, radii and bond order of the disks in the box, or in its middle where all would be
// too many to see.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "sandglass/core/state.h"

namespace sandglass {

struct Packing {
  double box_length = 0;
  double left = 0, bottom = 0, side = 0;  ///< the square that is shown; side = box_length when it is all
  std::array<double, species_count> radius{};
  std::vector<std::size_t> id;  ///< of the disks whose centre is in that square
  std::vector<double> x, y;     ///< in [0, box_length)
  std::vector<Species> species;
  std::vector<std::complex<double>> psi;  ///< psi_6 of each (observe/bond_order.h)
};

/// The disks of `state` at its own time. More than `most` are not drawn: then the square is the middle of the box, of
/// the size that holds `most` on average.
Packing packing_of(const State& state, std::size_t most = 20000);

}  // namespace sandglass
