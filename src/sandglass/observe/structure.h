// Pairs of disks in space: the radial distribution function and its value at contact.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sandglass/observe/population.h"

namespace sandglass {

/// Pairs of species in the order of Tally::contacts; `species[i] + species[j]` is the place of a pair.
inline constexpr std::array<const char*, 3> species_pairs{"small_small", "small_big", "big_big"};

/// Number of pairs: N_a (N_a - 1) / 2 within a species, N_a N_b across.
double pair_count(const Population& population, std::size_t pair);

/// Contact distance R_i + R_j of a pair of species.
double contact_distance(const Population& population, std::size_t pair);

/// Species of each disk, by id.
std::vector<std::uint8_t> species_by_id(const Population& population);

/// g(r) in rings of equal `width`, the first of which starts at `inner`: counted pairs over those expected for
/// independent uniform disks, pairs_per_area * pi (r2^2 - r1^2) with the exact area of each ring. `pairs_per_area` is
/// pair_count / L^2 times the number of frames; NaN where it is zero.
std::vector<double> radial_distribution(std::span<const std::uint64_t> counts, double inner, double width,
                                        double pairs_per_area);

/// Extrapolates what was counted in eight bins of equal width beside contact to contact: the least-squares parabola
/// through the eight, taken at the outer edge of the first, is the sum of edge_weight(bin) * value.
inline constexpr std::size_t edge_bins = 8;
double edge_weight(std::size_t bin);

/// Pairs by their gap, in contact distances: equal bins from 0 to gap_range.
inline constexpr std::size_t gap_bins = 1024;
inline constexpr double gap_range = 0.12;

/// How many of the gap bins the extrapolation to contact may use: g falls off over a gap of about 1 / (Z - 1), and
/// inelastic disks, which stay together after a collision, over less [see contact_range]; taken is a tenth of it with
/// Z - 1 = 2 eta g(contact), a multiple of eight bins. `counts`, `pairs_per_area` as in radial_distribution.
std::size_t contact_bins(std::span<const std::uint64_t> counts, double contact, double pairs_per_area,
                         double packing_fraction);

/// g at contact from the first `bins` gap bins.
double contact_value(std::span<const std::uint64_t> counts, std::size_t bins, double contact, double pairs_per_area);

}  // namespace sandglass
