// Static structure of one frame: radial distribution and structure factor.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sandglass/observe/population.h"

namespace sandglass {

/// Distances of pairs, counted by species (ss, sb, bb) in bins of equal width; frames may be added one after another.
struct PairHistogram {
  double bin_width = 0;
  std::array<std::vector<std::uint64_t>, 3> counts;
  std::uint64_t frames = 0;
};

/// An empty histogram up to `longest` <= L/2 (beyond it an annulus leaves the box). Throws InputError otherwise.
PairHistogram pair_histogram(const Population& population, double bin_width, double longest);

/// Counts every pair of `frame` once.
void add_pairs(const Frame& frame, const Population& population, PairHistogram& histogram);

/// g(r) by pairs of species, and for all: counted pairs over those expected for independent uniform disks,
/// pairs * (annulus area pi (r2^2 - r1^2)) / L^2, with N_a (N_a - 1) / 2 pairs within a species and N_a N_b across.
struct RadialDistribution {
  std::vector<double> r;  ///< middle of each bin
  std::vector<double> all, small_small, small_big, big_big;
};
RadialDistribution radial_distribution(const PairHistogram& histogram, const Population& population);

/// S(k) = |sum_j exp(-i k.r_j)|^2 / N over the disks of `range`, k = (2 pi / L)(m, n) with 0 <= m <= M, -M <= n <= M
/// and M = floor(longest L / 2 pi); S(-k) = S(k). The mode (0, 0) holds N.
struct StructureFactor {
  int modes = 0;               ///< M
  double spacing = 0;          ///< 2 pi / L
  std::vector<double> values;  ///< [m, n + M]
  [[nodiscard]] double at(int m, int n) const;
};
StructureFactor structure_factor(const Frame& frame, const Population& population, Range range, double longest);

/// Ring averages of S(k) in bins of `width` up to the longest |k| that is covered in all directions; empty rings are
/// left out.
struct RingAverage {
  std::vector<double> wavenumber;  ///< mean |k| of the ring
  std::vector<double> value;
  /// |<S e^{6 i phi}>| / <S>: zero for isotropic rings (the square's own directions cancel exactly) up to noise of
  /// about 1/sqrt(count), 1 for six sharp spots.
  std::vector<double> anisotropy;
  std::vector<std::uint64_t> count;
};
RingAverage ring_average(const StructureFactor& factor, double width);

}  // namespace sandglass
