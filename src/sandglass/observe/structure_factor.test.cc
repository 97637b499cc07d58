#include "sandglass/observe/structure_factor.h"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "sandglass/core/random.h"
#include "sandglass/observe/fourier.h"
#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

// |sum exp(-i k.r)|^2 / N straight from the definition.
double by_definition(const IdealGas& system, Range range, double kx, double ky) {
  std::complex<double> sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const std::uint32_t id = system.population.order[i];
    sum += std::polar(1.0, kx * system.frame.x[id] + ky * system.frame.y[id]);
  }
  return std::norm(sum) / static_cast<double>(range.size());
}

}  // namespace

TEST_CASE("a Fourier transform is the sum that defines it, column by column") {
  constexpr std::size_t rows = 16, width = 3;
  std::vector<double> re(rows * width), im(rows * width);
  for (std::size_t i = 0; i < re.size(); ++i)
    re[i] = uniform(random_words(1, Stream::probe, i, 0)[0]), im[i] = uniform(random_words(1, Stream::probe, i, 0)[1]);
  const std::vector<double> re0 = re, im0 = im;
  transform_columns(re, im, rows, width);
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t c = 0; c < width; ++c) {
      std::complex<double> sum = 0;
      for (std::size_t j = 0; j < rows; ++j)
        sum += std::complex(re0[j * width + c], im0[j * width + c]) *
               std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(j * k) / rows);
      CHECK(std::abs(std::complex(re[k * width + c], im[k * width + c]) - sum) < 1e-13);
    }
  }
}

TEST_CASE("every mode equals the sum that defines it, with and without a stride") {
  const IdealGas system = ideal_gas(500, 50, 7);
  for (const int most : {7, 40, 128}) {
    const DensityModes modes = density_modes(system.frame, system.population, 4, most);
    CHECK(modes.modes <= most);
    const double stride = modes.spacing / (2 * std::numbers::pi / 50);
    CHECK(std::fabs(stride - std::round(stride)) < 1e-12);
    CHECK((modes.modes + 1) * modes.spacing > 4);
    for (const Group group : groups) {
      const StructureFactor s = structure_factor(modes, group);
      for (int m = -s.modes; m <= s.modes; m += std::max(1, s.modes / 5)) {
        for (int n = -s.modes; n <= s.modes; n += std::max(1, s.modes / 5)) {
          const double exact = by_definition(system, system.population.range(group), m * s.spacing, n * s.spacing);
          // Amplitudes are right to 1e-12 sqrt(N), N = 500, and S to twice that times its root.
          CHECK(std::fabs(s.at(m, n) - exact) < 1e-10 * std::max(1.0, exact));
        }
      }
    }
  }
}

TEST_CASE("S(k) of a square lattice: N at the reciprocal lattice, else nothing") {
  constexpr int cells = 8;
  State state;
  state.box_length = 24;
  state.disks.resize(cells * cells);
  for (int i = 0; i < cells * cells; ++i) {
    state.disks[static_cast<std::size_t>(i)].x = 3.0 * (i % cells) + 0.7;
    state.disks[static_cast<std::size_t>(i)].y = 3.0 * (i / cells) + 0.1;
  }
  const Population population = population_of(state);
  Frame frame;
  make_frame(state, frame);
  const StructureFactor s =
      structure_factor(density_modes(frame, population, 20 * 2 * std::numbers::pi / 24), Group::small);
  REQUIRE(s.modes == 20);
  for (int m = -20; m <= 20; ++m) {
    for (int n = -20; n <= 20; ++n) {
      const double expected = m % cells == 0 && n % cells == 0 ? 64 : 0;
      // Amplitudes of 64 unit vectors, phases good to 1e-13: 64 * 1e-12 in |sum|^2 / N.
      CHECK(std::fabs(s.at(m, n) - expected) < 1e-9);
    }
  }
  // Rings: the first spots at k = 8 units are 2 of the ring's vectors.
  const RingAverage ring = ring_average(s, s.spacing);
  for (std::size_t i = 0; i < ring.value.size(); ++i) {
    const bool spots = std::fabs(ring.wavenumber[i] / s.spacing - 8.5) < 0.5;
    if (spots) CHECK(ring.value[i] == doctest::Approx(2 * 64 / static_cast<double>(ring.count[i])));
  }
}

TEST_CASE("S(k) of an ideal gas is 1 on rings, isotropic") {
  const IdealGas system = ideal_gas(2000, 50, 21);
  const StructureFactor s = structure_factor(density_modes(system.frame, system.population, 3), Group::small);
  const RingAverage ring = ring_average(s, 0.3);
  for (std::size_t i = 0; i < ring.value.size(); ++i) {
    // A mode is exponential with mean and sigma 1; |<S e^{6 i phi}>| has sigma 1 / sqrt(count) in all, five of them.
    const double sigma = 1 / std::sqrt(static_cast<double>(ring.count[i]));
    CHECK(std::fabs(ring.value[i] - 1) < 5 * sigma);
    if (ring.count[i] > 30) CHECK(ring.anisotropy[i] < 5 * sigma);
  }
}
