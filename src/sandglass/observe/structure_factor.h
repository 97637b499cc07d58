// The static structure factor of one frame, as a map and on rings.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/observe/population.h"

namespace sandglass {

/// Fourier modes rho(k) = sum_j exp(-i k.r_j) of the centres of each species on a square of wave vectors
/// k = spacing (m, n), -M <= m, n <= M. `spacing` is 2 pi / L times a whole `stride`: a large box allows more modes
/// than anybody looks at, and every stride-th of them is taken, exactly.
///
/// The disks are spread over a grid by a smooth kernel of 14 x 14 points, transformed, and divided by the transform of
/// the kernel [GreengardLee 2004; kernel of Barnett 2019]: relative error 1e-12 of
/// sqrt(N), at a cost of N log N instead of N M^2.
struct DensityModes {
  int modes = 0;       ///< M
  double spacing = 0;  ///< in 1/R_s
  std::size_t disks[species_count] = {};
  std::vector<double> real[species_count], imaginary[species_count];  ///< [m, n + M] with 0 <= m <= M
};

/// Modes up to |m|, |n| <= M = floor(longest / spacing), the stride being the smallest for which M <= most_modes.
DensityModes density_modes(const Frame& frame, const Population& population, double longest, int most_modes = 128);

/// S(k) = |sum_j exp(-i k.r_j)|^2 / N over the disks of a group; S(-k) = S(k). The mode (0, 0) holds N.
struct StructureFactor {
  int modes = 0;               ///< M
  double spacing = 0;          ///< in 1/R_s
  std::vector<double> values;  ///< [m, n + M] with 0 <= m <= M
  [[nodiscard]] double at(int m, int n) const;
};
StructureFactor structure_factor(const DensityModes& modes, Group group);

/// Ring averages of S(k) in bins of `width` up to the longest |k| that is covered in all directions; empty rings are
/// left out.
struct RingAverage {
  std::vector<double> wavenumber;  ///< mean |k| of the ring
  std::vector<double> value;
  /// |<S e^{6 i phi}>| / <S>: zero for isotropic rings (the square's own directions cancel exactly) up to noise of
  /// about 1/sqrt(count), 1 for six sharp spots.
  std::vector<double> anisotropy;
  std::vector<std::uint64_t> count;  ///< wave vectors; of k and -k only one
};
RingAverage ring_average(const StructureFactor& factor, double width);

}  // namespace sandglass
