// The packings that runs start from: amorphous, isotropic, and independent for independent seeds.
//
// False alarms: a check compares an exponentially distributed intensity with its mean m and fails above m (ln n + 14),
// n being the number of intensities looked at, which a right program does once in 10^6 seeds. Seeds are fixed.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/observe/bond_order.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/structure_factor.h"
#include "sandglass/prepare/periodic.h"
#include "sandglass/prepare/prepare.h"

using namespace sandglass;

namespace {

constexpr std::size_t particles = 10000;
constexpr double surprise = 14;

struct Packing {
  State state;
  Population population;
  Frame frame;
};

Packing packing(double size_ratio, std::uint64_t seed) {
  Packing made;
  const Mixture mixture{{1, size_ratio}, {1, size_ratio * size_ratio}};
  made.state = quench_disks(particles / 2, particles / 2, mixture, 0.8, seed);
  made.population = population_of(made.state);
  make_frame(made.state, made.frame);
  return made;
}

/// What the checks must tell from a packing: small disks on a triangular lattice, a little stretched to fit the square.
Packing lattice() {
  Packing made;
  made.state.box_length = 240;
  for (int row = 0; row < 108; ++row) {
    for (int column = 0; column < 94; ++column) {
      Disk& disk = made.state.disks.emplace_back();
      disk.x = 240.0 * (column + 0.5 * (row % 2)) / 94;
      disk.y = 240.0 * row / 108;
    }
  }
  made.population = population_of(made.state);
  make_frame(made.state, made.frame);
  return made;
}

struct Hexatic {
  double global = 0;  ///< |<psi_6>|
  double correlated_disks =
      0;  ///< n <|psi_6 of a block|^2>: how many disks share one orientation, times their |psi_6|^2
};

/// The box is cut into 8 x 8 blocks of about 156 disks.
Hexatic hexatic(const Packing& made) {
  constexpr std::size_t side = 8;
  const auto psi = bond_order(made.frame, made.population);
  std::vector<std::complex<double>> sum(side * side);
  std::vector<double> count(side * side);
  for (std::size_t id = 0; id < psi.size(); ++id) {
    const auto cell = [&](double x) { return static_cast<std::size_t>(x / made.state.box_length * side); };
    const std::size_t block = cell(made.frame.y[id]) * side + cell(made.frame.x[id]);
    sum[block] += psi[id];
    count[block] += 1;
  }
  Hexatic result{.global = global_bond_order(psi)};
  for (std::size_t block = 0; block < sum.size(); ++block) {
    result.correlated_disks += std::norm(sum[block]) / count[block] / static_cast<double>(sum.size());
  }
  return result;
}

struct Speckle {
  double brightest = 0;    ///< the greatest S(k) over the mean of its ring
  double anisotropic = 0;  ///< the greatest count |<S e^{6 i phi}>|^2 / <S>^2 of a ring
  double modes = 0, rings = 0;
};

/// The modes of the small disks up to |k| = 4, beyond the main peak near 2.6 and its shoulder, in rings 0.05 wide.
Speckle speckle(const Packing& made) {
  constexpr double width = 0.05, longest = 4;
  const auto factor = structure_factor(density_modes(made.frame, made.population, longest, 1000), Group::small);
  std::vector<double> sum(static_cast<std::size_t>(longest / width) + 1), count(sum.size());
  const auto each_mode = [&](auto&& act) {
    for (int m = 0; m <= factor.modes; ++m) {
      for (int n = -factor.modes; n <= factor.modes; ++n) {
        if (m == 0 && n <= 0) continue;  // S(-k) = S(k), and k = 0
        const double k = factor.spacing * std::hypot(m, n);
        if (k < longest) act(static_cast<std::size_t>(k / width), factor.at(m, n));
      }
    }
  };
  Speckle result;
  each_mode([&](std::size_t ring, double value) { sum[ring] += value, count[ring] += 1, result.modes += 1; });
  each_mode([&](std::size_t ring, double value) {
    result.brightest = std::max(result.brightest, value * count[ring] / sum[ring]);
  });
  const RingAverage rings = ring_average(factor, width);
  for (std::size_t ring = 0; ring < rings.count.size(); ++ring) {
    const double strength = rings.anisotropy[ring] * rings.anisotropy[ring];
    result.anisotropic = std::max(result.anisotropic, strength * static_cast<double>(rings.count[ring]));
    result.rings += 1;
  }
  return result;
}

/// Pairs of one centre from each packing closer than `distance`, in the box of both.
double coincidences(const Packing& a, const Packing& b, double distance) {
  const double box = a.state.box_length;
  double pairs = 0;
  for (const Disk& p : a.state.disks) {
    for (const Disk& q : b.state.disks) {
      const double dx = nearest_image(p.x - q.x, box), dy = nearest_image(p.y - q.y, box);
      pairs += dx * dx + dy * dy < distance * distance;
    }
  }
  return pairs;
}

}  // namespace

TEST_CASE("mixtures are packed without hexatic order, equal disks with it") {
  // psi_6 of a block is a sum over many independent patches, so |psi_6|^2 of the whole is exponential with mean
  // correlated_disks / N. A disk with its first shell (7 disks) and |psi_6|^2 of about 0.3 gives correlated_disks = 2,
  // its mean over 64 blocks scatters by 2 / 8, which leaves 4 for eight sigma. Grains would fill the blocks: 156
  // |psi_6|^2.
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Hexatic mixed = hexatic(packing(1.43, seed));
    MESSAGE("seed ", seed, ": |psi_6| = ", mixed.global, ", correlated disks ", mixed.correlated_disks);
    CHECK(mixed.correlated_disks < 4);
    CHECK(mixed.global * mixed.global < surprise * mixed.correlated_disks / particles);
  }
  const Hexatic equal = hexatic(packing(1, 1));
  MESSAGE("equal disks: |psi_6| = ", equal.global, ", correlated disks ", equal.correlated_disks);
  CHECK(equal.correlated_disks > 30);
}

TEST_CASE("mixtures scatter in isotropic rings without Bragg peaks, a lattice does not") {
  // Each amplitude is a sum over many independent patches: complex Gaussian, its intensity S(k) exponential about the
  // mean of its ring. So is, by the same argument, the intensity of the sixfold component of a ring, with mean
  // <S>^2 <S^2> / <S>^2 / count = 2 / count where S itself does not vary along the ring's width.
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Speckle mixed = speckle(packing(1.43, seed));
    MESSAGE("seed ", seed, ": brightest ", mixed.brightest, " of ", mixed.modes, " modes, anisotropic ",
            mixed.anisotropic);
    CHECK(mixed.brightest < std::log(mixed.modes) + surprise);
    CHECK(mixed.anisotropic < 2 * (std::log(mixed.rings) + surprise));
  }
  const Speckle ordered = speckle(lattice());
  MESSAGE("lattice: brightest ", ordered.brightest, ", anisotropic ", ordered.anisotropic);
  CHECK(ordered.brightest > 10 * (std::log(ordered.modes) + surprise));
  CHECK(ordered.anisotropic > 20 * (std::log(ordered.rings) + surprise));
}

TEST_CASE("packings of different seeds are independent") {
  // The N^2 pairs of centres from two independent packings are closer than d = 0.5 with probability pi d^2 / L^2 each.
  // No disk of one packing has two of the other that close, so the count is at most binomial in its scatter: sigma is
  // at most the root of the mean, and packings that cover space evenly have less. 5 sigma, false alarm below 6e-7.
  constexpr double distance = 0.5;
  const Packing first = packing(1.43, 1), second = packing(1.43, 2);
  const double expected =
      std::pow(static_cast<double>(particles) * distance / first.state.box_length, 2) * std::numbers::pi;
  const double found = coincidences(first, second, distance);
  MESSAGE("coincidences: ", found, ", expected ", expected);
  CHECK(std::fabs(found - expected) < 5 * std::sqrt(expected));
  CHECK(coincidences(first, first, distance) == particles);
}
