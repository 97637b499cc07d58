// Self-intermediate scattering between two moments.
#pragma once

#include <array>
#include <vector>

#include "sandglass/core/exact_sum.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// The wave vectors k = (2 pi / L)(m, n) that the box allows and that stand for one wavenumber; of k and -k only one.
struct WaveShell {
  double wavenumber = 0;                  ///< mean |k| of the vectors, in 1/R_s
  std::vector<std::array<int, 2>> modes;  ///< (m, n)

  [[nodiscard]] double squared(std::size_t mode, double box_length) const;  ///< k^2 of one vector
};

/// Whole sets of equal |k| (all directions that the symmetry of the square makes equal), nearest to `wavenumber` first,
/// until there are four to six vectors; sets that are more than 5 % of |k| from the nearest one are left out, so that
/// a small box gives fewer directions rather than wrong wavenumbers. Throws InputError where the box holds more than
/// `most_waves` wavelengths: finding the vectors takes as many steps.
inline constexpr double most_waves = 1 << 20;
WaveShell wave_shell(double wavenumber, double box_length);

/// Adds sum_i <cos k.dr_i>, averaged over the vectors of the shell, over the disks of `range`.
void add_scattering(const Snapshot& origin, const Snapshot& now, Range range, const WaveShell& shell, double box_length,
                    ExactSum& sum);

/// Gaussian approximation of S_inc at a given mean square displacement: <exp(-k^2 MSD / 4)> over the shell, and its
/// derivative with respect to the MSD.
struct GaussianApproximation {
  double value = 0, derivative = 0;
};
GaussianApproximation gaussian_approximation(const WaveShell& shell, double box_length, double mean_square);

}  // namespace sandglass
