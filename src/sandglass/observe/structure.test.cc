#include "sandglass/observe/structure.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

struct System {
  Frame frame;
  Population population;
};

// Uniform points, unwrapped over several boxes; every third one is big.
System ideal_gas(std::size_t n, double box_length, std::uint64_t seed) {
  State state;
  state.box_length = box_length;
  state.disks.resize(n);
  for (std::size_t id = 0; id < n; ++id) {
    const auto words = random_words(seed, Stream::positions, id, 0);
    state.disks[id].x = box_length * uniform(words[0]);
    state.disks[id].y = box_length * uniform(words[1]);
    state.disks[id].image_x = static_cast<int>(words[2] % 5) - 2;
    state.disks[id].species = id % 3 == 1 ? big : small;
  }
  System system{{}, population_of(state)};
  make_frame(state, system.frame);
  return system;
}

}  // namespace

TEST_CASE("g(r) of an ideal gas is 1 in every pair of species") {
  const System system = ideal_gas(3000, 60, 3);
  PairHistogram histogram = pair_histogram(system.population, 0.5, 10);
  add_pairs(system.frame, system.population, histogram);
  const RadialDistribution g = radial_distribution(histogram, system.population);
  REQUIRE(g.r.size() == 20);
  for (std::size_t b = 0; b < 20; ++b) {
    CHECK(g.r[b] == doctest::Approx(0.25 + 0.5 * static_cast<double>(b)));
    // Counts are Poisson to good accuracy: sigma = 1 / sqrt(expected), five of them.
    const double share = std::numbers::pi * 0.5 * (2 * g.r[b]) / 3600;
    CHECK(std::fabs(g.small_small[b] - 1) < 5 / std::sqrt(share * 2000 * 1999 / 2));
    CHECK(std::fabs(g.small_big[b] - 1) < 5 / std::sqrt(share * 2000 * 1000));
    CHECK(std::fabs(g.big_big[b] - 1) < 5 / std::sqrt(share * 1000 * 999 / 2));
    CHECK(std::fabs(g.all[b] - 1) < 5 / std::sqrt(share * 3000 * 2999 / 2));
  }
  CHECK_THROWS_AS(pair_histogram(system.population, 0.5, 31), InputError);
}

TEST_CASE("pairs are counted as by brute force, in few and in many cells") {
  for (const double longest : {2.0, 9.0, 20.0}) {
    const System system = ideal_gas(300, 40, 12);
    PairHistogram histogram = pair_histogram(system.population, 0.25, longest);
    add_pairs(system.frame, system.population, histogram);
    PairHistogram brute = pair_histogram(system.population, 0.25, longest);
    for (std::size_t i = 0; i < 300; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        double dx = system.frame.x[i] - system.frame.x[j], dy = system.frame.y[i] - system.frame.y[j];
        dx -= 40 * std::round(dx / 40);
        dy -= 40 * std::round(dy / 40);
        const auto bin = static_cast<std::size_t>(std::hypot(dx, dy) / 0.25);
        if (bin < brute.counts[0].size()) ++brute.counts[(i % 3 == 1) + (j % 3 == 1)][bin];
      }
    }
    CHECK(histogram.counts == brute.counts);
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
      structure_factor(frame, population, population.range(small), 20 * 2 * std::numbers::pi / 24);
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
  const System system = ideal_gas(2000, 50, 21);
  const Range range = system.population.range(small);
  const StructureFactor s = structure_factor(system.frame, system.population, range, 3);
  // One mode straight from the definition.
  double re = 0, im = 0;
  for (std::size_t i = 0; i < range.size(); ++i) {
    const std::uint32_t id = system.population.order[i];
    const double phase = 2 * std::numbers::pi / 50 * (7 * system.frame.x[id] - 11 * system.frame.y[id]);
    re += std::cos(phase);
    im += std::sin(phase);
  }
  CHECK(s.at(7, -11) == doctest::Approx((re * re + im * im) / static_cast<double>(range.size())).epsilon(1e-9));
  CHECK(s.at(-7, 11) == s.at(7, -11));
  const RingAverage ring = ring_average(s, 0.3);
  for (std::size_t i = 0; i < ring.value.size(); ++i) {
    // A mode is exponential with mean and sigma 1; |<S e^{6 i phi}>| has sigma 1 / sqrt(count) in all, five of them.
    const double sigma = 1 / std::sqrt(static_cast<double>(ring.count[i]));
    CHECK(std::fabs(ring.value[i] - 1) < 5 * sigma);
    if (ring.count[i] > 30) CHECK(ring.anisotropy[i] < 5 * sigma);
  }
}
