#include "sandglass/observe/structure.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/observe/cells.h"

namespace sandglass {
namespace {

std::vector<std::uint8_t> species_by_id(const Population& population) {
  std::vector<std::uint8_t> species(population.size(), small);
  for (std::size_t i = population.small_count; i < population.size(); ++i) species[population.order[i]] = big;
  return species;
}

}  // namespace

PairHistogram pair_histogram(const Population& population, double bin_width, double longest) {
  if (!(bin_width > 0) || !(longest >= bin_width) || longest > population.box_length / 2)
    throw InputError(
        "g(r) needs a positive bin width and a range of at most half the box, because beyond it a ring "
        "leaves the box; choose a shorter range.");
  PairHistogram histogram;
  histogram.bin_width = bin_width;
  for (auto& counts : histogram.counts) counts.assign(static_cast<std::size_t>(longest / bin_width + 1e-9), 0);
  return histogram;
}

void add_pairs(const Frame& frame, const Population& population, PairHistogram& histogram) {
  const std::vector<std::uint8_t> species = species_by_id(population);
  const std::size_t bins = histogram.counts[0].size();
  const Cells cells(frame, population.box_length, static_cast<double>(bins) * histogram.bin_width);
  std::vector<Cells::Neighbour> near;
  for (std::uint32_t id = 0; id < frame.size(); ++id) {
    cells.collect(id, 1, near);
    for (const auto& neighbour : near) {
      if (neighbour.id < id) continue;
      const double bin = std::sqrt(neighbour.squared()) / histogram.bin_width;
      if (bin < static_cast<double>(bins))
        ++histogram.counts[species[id] + species[neighbour.id]][static_cast<std::size_t>(bin)];
    }
  }
  ++histogram.frames;
}

RadialDistribution radial_distribution(const PairHistogram& histogram, const Population& population) {
  const auto ns = static_cast<double>(population.range(small).size());
  const auto nb = static_cast<double>(population.range(big).size());
  const double area = population.box_length * population.box_length;
  const std::size_t bins = histogram.counts[0].size();
  RadialDistribution g;
  auto normalised = [&](double pairs, auto&& counted) {
    std::vector<double> values(bins);
    for (std::size_t b = 0; b < bins; ++b) {
      const double inner = static_cast<double>(b) * histogram.bin_width, outer = inner + histogram.bin_width;
      const double annulus = std::numbers::pi * (outer * outer - inner * inner);
      const double expected = pairs * annulus / area * static_cast<double>(histogram.frames);
      values[b] = expected > 0 ? static_cast<double>(counted(b)) / expected : std::numeric_limits<double>::quiet_NaN();
    }
    return values;
  };
  const auto& counts = histogram.counts;
  for (std::size_t b = 0; b < bins; ++b) g.r.push_back((static_cast<double>(b) + 0.5) * histogram.bin_width);
  g.small_small = normalised(ns * (ns - 1) / 2, [&](std::size_t b) { return counts[0][b]; });
  g.small_big = normalised(ns * nb, [&](std::size_t b) { return counts[1][b]; });
  g.big_big = normalised(nb * (nb - 1) / 2, [&](std::size_t b) { return counts[2][b]; });
  g.all = normalised((ns + nb) * (ns + nb - 1) / 2,
                     [&](std::size_t b) { return counts[0][b] + counts[1][b] + counts[2][b]; });
  return g;
}

double StructureFactor::at(int m, int n) const {
  if (m < 0) return at(-m, -n);
  return values[static_cast<std::size_t>(m) * static_cast<std::size_t>(2 * modes + 1) +
                static_cast<std::size_t>(n + modes)];
}

StructureFactor structure_factor(const Frame& frame, const Population& population, Range range, double longest) {
  StructureFactor factor;
  factor.spacing = 2 * std::numbers::pi / population.box_length;
  factor.modes = static_cast<int>(longest / factor.spacing + 1e-9);
  const auto rows = static_cast<std::size_t>(factor.modes) + 1, width = 2 * rows - 1;
  std::vector<double> real(rows * width, 0.0), imaginary(rows * width, 0.0), cosine(width), sine(width);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const std::uint32_t id = population.order[i];
    const auto step_x = std::polar(1.0, factor.spacing * frame.x[id]);
    const auto step_y = std::polar(1.0, factor.spacing * frame.y[id]);
    auto y = std::complex<double>(1);
    for (std::size_t n = 0; n < rows; ++n, y *= step_y) {
      cosine[rows - 1 + n] = cosine[rows - 1 - n] = y.real();
      sine[rows - 1 + n] = y.imag();
      sine[rows - 1 - n] = -y.imag();
    }
    auto x = std::complex<double>(1);
    for (std::size_t m = 0; m < rows; ++m, x *= step_x) {
      double* re = &real[m * width];
      double* im = &imaginary[m * width];
      const double c = x.real(), s = x.imag();
      for (std::size_t n = 0; n < width; ++n) {
        re[n] += c * cosine[n] - s * sine[n];
        im[n] += c * sine[n] + s * cosine[n];
      }
    }
  }
  for (std::size_t k = 0; k < real.size(); ++k)
    factor.values.push_back((real[k] * real[k] + imaginary[k] * imaginary[k]) / static_cast<double>(range.size()));
  return factor;
}

RingAverage ring_average(const StructureFactor& factor, double width) {
  struct Ring {
    double k = 0, value = 0;
    std::complex<double> sixfold;
    std::uint64_t count = 0;
  };
  const double longest = factor.modes * factor.spacing * (1 + 1e-12);
  std::vector<Ring> rings(static_cast<std::size_t>(longest / width) + 1);
  for (int m = 0; m <= factor.modes; ++m) {
    for (int n = m > 0 ? -factor.modes : 1; n <= factor.modes; ++n) {
      const double k = factor.spacing * std::hypot(m, n);
      if (k > longest) continue;
      Ring& ring = rings[static_cast<std::size_t>(k / width)];
      ring.k += k;
      ring.value += factor.at(m, n);
      ring.sixfold += factor.at(m, n) * std::polar(1.0, 6 * std::atan2(n, m));
      ++ring.count;
    }
  }
  RingAverage average;
  for (const Ring& ring : rings) {
    if (ring.count == 0) continue;
    const auto count = static_cast<double>(ring.count);
    average.wavenumber.push_back(ring.k / count);
    average.value.push_back(ring.value / count);
    average.anisotropy.push_back(ring.value > 0 ? std::abs(ring.sixfold) / ring.value : 0);
    average.count.push_back(ring.count);
  }
  return average;
}

}  // namespace sandglass
