#include "sandglass/observe/structure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace sandglass {

double pair_count(const Population& population, std::size_t pair) {
  const auto ns = static_cast<double>(population.range(small).size());
  const auto nb = static_cast<double>(population.range(big).size());
  return pair == 0 ? ns * (ns - 1) / 2 : pair == 1 ? ns * nb : nb * (nb - 1) / 2;
}

double contact_distance(const Population& population, std::size_t pair) {
  const auto& radius = population.mixture.radius;
  return radius[pair == 2 ? big : small] + radius[pair == 0 ? small : big];
}

std::vector<std::uint8_t> species_by_id(const Population& population) {
  std::vector<std::uint8_t> species(population.size(), small);
  for (std::size_t i = population.small_count; i < population.size(); ++i) species[population.order[i]] = big;
  return species;
}

std::vector<double> radial_distribution(std::span<const std::uint64_t> counts, double inner, double width,
                                        double pairs_per_area) {
  std::vector<double> g;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    const double r1 = inner + static_cast<double>(bin) * width, r2 = r1 + width;
    const double expected = pairs_per_area * std::numbers::pi * (r2 * r2 - r1 * r1);
    g.push_back(expected > 0 ? static_cast<double>(counts[bin]) / expected : std::numeric_limits<double>::quiet_NaN());
  }
  return g;
}

// The bins are centred at u = -7/2 ... 7/2, the edge is at u = -4; sum u^2 = 42, sum u^4 = 388.5.
double edge_weight(std::size_t bin) {
  const double u = static_cast<double>(bin) - 3.5;
  return -4 * u / 42 + (86 * u * u - 283.5) / (8 * 388.5 - 42 * 42);
}

namespace {

/// g in `merged` equal parts of the first `bins` gap bins.
std::vector<double> merged_distribution(std::span<const std::uint64_t> counts, std::size_t bins, std::size_t merged,
                                        double contact, double pairs_per_area) {
  std::vector<std::uint64_t> sums;
  const std::size_t each = bins / merged;
  for (std::size_t part = 0; part < merged; ++part) {
    const auto first = counts.begin() + static_cast<std::ptrdiff_t>(part * each);
    sums.push_back(std::accumulate(first, first + static_cast<std::ptrdiff_t>(each), std::uint64_t{0}));
  }
  const double width = contact * gap_range / gap_bins * static_cast<double>(each);
  return radial_distribution(sums, contact, width, pairs_per_area);
}

}  // namespace

std::size_t contact_bins(std::span<const std::uint64_t> counts, double contact, double pairs_per_area,
                         double packing_fraction) {
  std::size_t bins = gap_bins;
  for (int step = 0; step < 8; ++step) {
    const double g = merged_distribution(counts, bins, 1, contact, pairs_per_area)[0];
    const double wanted = 0.1 / (2 * packing_fraction * g) / gap_range * gap_bins;
    const auto parts = static_cast<std::size_t>(std::clamp(wanted / edge_bins, 1.0, double{gap_bins} / edge_bins));
    if (parts * edge_bins == bins) break;
    bins = parts * edge_bins;
  }
  return bins;
}

double contact_value(std::span<const std::uint64_t> counts, std::size_t bins, double contact, double pairs_per_area) {
  const std::vector<double> g = merged_distribution(counts, bins, edge_bins, contact, pairs_per_area);
  double value = 0;
  for (std::size_t bin = 0; bin < edge_bins; ++bin) value += edge_weight(bin) * g[bin];
  return value;
}

}  // namespace sandglass
