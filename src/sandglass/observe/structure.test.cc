#include "sandglass/observe/structure.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "sandglass/observe/cells.h"
#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

// Pairs counted by distance, for each pair of species.
std::array<std::vector<std::uint64_t>, 3> count_pairs(const IdealGas& system, double width, std::size_t bins) {
  std::array<std::vector<std::uint64_t>, 3> counts;
  for (auto& list : counts) list.resize(bins);
  const std::vector<std::uint8_t> species = species_by_id(system.population);
  const double range = width * static_cast<double>(bins);
  const Cells cells(system.frame.x, system.frame.y, system.population.box_length, range / 4);
  cells.for_each_pair(range, [&](std::size_t a, std::size_t b, double squared) {
    const std::uint32_t i = cells.order()[a], j = cells.order()[b];
    const auto bin = static_cast<std::size_t>(std::sqrt(squared) / width);
    if (bin < bins) ++counts[species[i] + species[j]][bin];
  });
  return counts;
}

}  // namespace

TEST_CASE("pairs are counted as by brute force, in few and in many cells") {
  for (const std::size_t bins : {8, 36, 80}) {
    const IdealGas system = ideal_gas(300, 40, 12);
    std::array<std::vector<std::uint64_t>, 3> brute;
    for (auto& list : brute) list.resize(bins);
    for (std::size_t i = 0; i < 300; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        double dx = system.frame.x[i] - system.frame.x[j], dy = system.frame.y[i] - system.frame.y[j];
        dx -= 40 * std::round(dx / 40);
        dy -= 40 * std::round(dy / 40);
        const auto bin = static_cast<std::size_t>(std::hypot(dx, dy) / 0.25);
        if (bin < bins) ++brute[(i % 3 == 1) + (j % 3 == 1)][bin];
      }
    }
    CHECK(count_pairs(system, 0.25, bins) == brute);
  }
}

TEST_CASE("g(r) of an ideal gas is 1 in every pair of species") {
  const IdealGas system = ideal_gas(3000, 60, 3);
  const auto counts = count_pairs(system, 0.5, 20);
  for (std::size_t pair = 0; pair < 3; ++pair) {
    const double per_area = pair_count(system.population, pair) / 3600;
    const std::vector<double> g = radial_distribution(counts[pair], 0, 0.5, per_area);
    for (std::size_t b = 0; b < 20; ++b) {
      // Counts are Poisson to good accuracy: sigma = 1 / sqrt(expected), five of them.
      const double expected = per_area * std::numbers::pi * 0.5 * (2 * 0.5 * (static_cast<double>(b) + 0.5));
      CHECK(std::fabs(g[b] - 1) < 5 / std::sqrt(expected));
    }
  }
}

TEST_CASE("g at contact: a parabola is met exactly, and the range shrinks as g grows") {
  // Counts of a g(x) = g0 (1 - 40 x + 500 x^2) in the gap x; rounded to whole pairs of some 10^7, hence 1e-6.
  const double contact = 2.43, g0 = 9, per_area = 1e10;
  std::vector<std::uint64_t> counts(gap_bins);
  // Means over a bin of width w exceed the middle's value by g0 500 w^2 / 12, which shifts the whole parabola.
  for (std::size_t b = 0; b < gap_bins; ++b) {
    const double w = gap_range / gap_bins, x = (static_cast<double>(b) + 0.5) * w;
    const double ring =
        std::numbers::pi * contact * contact * (std::pow(1 + x + w / 2, 2) - std::pow(1 + x - w / 2, 2));
    counts[b] = static_cast<std::uint64_t>(std::llround(per_area * ring * g0 * (1 - 40 * x + 500 * x * x)));
  }
  const std::size_t bins = contact_bins(counts, contact, per_area, 0.7);
  // A tenth of 1 / (2 eta g) with g ~ 0.9 g0 is 0.0088: about 75 of 1024 bins.
  CHECK(bins % 8 == 0);
  CHECK(bins > 56);
  CHECK(bins < 96);
  CHECK(contact_value(counts, bins, contact, per_area) == doctest::Approx(g0).epsilon(1e-4));
  CHECK(contact_bins(counts, contact, per_area, 0.07) > 6 * bins);
  double weights = 0;
  for (std::size_t b = 0; b < edge_bins; ++b) weights += edge_weight(b);
  CHECK(weights == doctest::Approx(1).epsilon(1e-12));
}
