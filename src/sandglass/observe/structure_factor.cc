#include "sandglass/observe/structure_factor.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "sandglass/observe/fourier.h"
#include "sandglass/observe/portable.h"

namespace sandglass {
namespace {

constexpr std::size_t kernel_width = 14;  // in grid points
constexpr double kernel_shape = 2.30 * kernel_width;

/// exp(beta (sqrt(1 - z^2) - 1)) at a distance of `x` grid points.
double kernel(double x) {
  const double z = 2 * x / kernel_width;
  return z * z < 1 ? portable_exp(kernel_shape * (std::sqrt(1 - z * z) - 1)) : 0;
}

/// Integral of kernel(x) cos(2 pi frequency x): the trapezoidal rule converges exponentially for so smooth a function,
/// which ends at exp(-beta) = 1e-14.
double kernel_transform(double frequency) {
  constexpr int steps = 1024;
  constexpr double h = static_cast<double>(kernel_width) / steps;
  const auto place = [](int i) { return h * i - kernel_width / 2.0; };
  static const std::vector<double> kernels = [&] {
    std::vector<double> values(steps);
    for (int i = 1; i < steps; ++i) values[static_cast<std::size_t>(i)] = kernel(place(i));
    return values;
  }();
  double sum = 0;
  for (int i = 1; i < steps; ++i) sum += kernels[static_cast<std::size_t>(i)] * cosine_of_turns(frequency * place(i));
  return sum * h;
}

/// Where a disk touches the grid along one axis: the first point, and the kernel at it and the following ones.
struct Touch {
  std::size_t first;
  std::array<double, kernel_width> weight;
};

/// The kernel at the points that a disk touches, tabulated by where it stands between two grid points; cubic
/// interpolation leaves an error of 1e-13.
class TabulatedKernel {
 public:
  TabulatedKernel() : rows_(steps + 3) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double offset = (static_cast<double>(i) - 1) / steps;
      for (std::size_t a = 0; a < kernel_width; ++a)
        rows_[i][a] = kernel(offset - kernel_width / 2.0 + static_cast<double>(a));
    }
  }

  [[nodiscard]] Touch touch(double turns, std::size_t grid) const {
    const double place = (turns - std::floor(turns)) * static_cast<double>(grid);
    const double first = std::ceil(place - kernel_width / 2.0);
    const double offset = (first - place + kernel_width / 2.0) * steps;  // in [0, steps)
    const auto i = std::min(static_cast<std::size_t>(offset), std::size_t{steps - 1});
    const double u = offset - static_cast<double>(i);
    // Lagrange's polynomial through the rows i - 1 ... i + 2, which stand one place further on.
    const double c0 = -u * (u - 1) * (u - 2) / 6, c1 = (u + 1) * (u - 1) * (u - 2) / 2;
    const double c2 = -(u + 1) * u * (u - 2) / 2, c3 = (u + 1) * u * (u - 1) / 6;
    Touch t;
    for (std::size_t a = 0; a < kernel_width; ++a)
      t.weight[a] = c0 * rows_[i][a] + c1 * rows_[i + 1][a] + c2 * rows_[i + 2][a] + c3 * rows_[i + 3][a];
    t.first = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(first) + static_cast<std::ptrdiff_t>(grid)) % grid;
    return t;
  }

 private:
  static constexpr int steps = 1024;
  std::vector<std::array<double, kernel_width>> rows_;
};

/// The centres of a species on a grid [y, x].
void spread(const Frame& frame, const Population& population, Species species, double turns_per_length,
            const TabulatedKernel& tabulated, std::size_t grid, std::vector<double>& values) {
  const Range range = population.range(species);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const std::uint32_t id = population.order[i];
    const Touch x = tabulated.touch(frame.x[id] * turns_per_length, grid);
    const Touch y = tabulated.touch(frame.y[id] * turns_per_length, grid);
    for (std::size_t b = 0; b < kernel_width; ++b) {
      double* row = &values[(y.first + b) % grid * grid];
      const std::size_t before_edge = std::min(kernel_width, grid - x.first);
      for (std::size_t a = 0; a < before_edge; ++a) row[x.first + a] += y.weight[b] * x.weight[a];
      for (std::size_t a = before_edge; a < kernel_width; ++a) row[a - before_edge] += y.weight[b] * x.weight[a];
    }
  }
}

}  // namespace

// Both species go through one transform as real and imaginary part; F(k) and F(-k) then tell them apart.
DensityModes density_modes(const Frame& frame, const Population& population, double longest, int most_modes) {
  const double unit = 2 * std::numbers::pi / population.box_length;
  const double stride = std::max(1.0, std::ceil(longest * (1 - 1e-9) / (unit * (most_modes + 1))));
  DensityModes result;
  result.spacing = unit * stride;
  result.modes = std::min(most_modes, static_cast<int>(longest / result.spacing + 1e-9));
  for (const Species species : {small, big}) result.disks[species] = population.range(species).size();
  const auto m_max = static_cast<std::size_t>(result.modes), width = 2 * m_max + 1;
  const std::size_t grid = std::bit_ceil(std::max<std::size_t>(4 * m_max, 2 * kernel_width));

  std::vector<double> re(grid * grid), im(grid * grid);
  static const TabulatedKernel tabulated;
  spread(frame, population, small, stride / population.box_length, tabulated, grid, re);
  spread(frame, population, big, stride / population.box_length, tabulated, grid, im);
  transform_columns(re, im, grid, grid);
  // Only the rows -M <= n <= M are needed now: turned over into columns for the other direction.
  const auto turn = [&](std::vector<double>& values) {
    std::vector<double> turned(grid * width);
    for (std::size_t n = 0; n < width; ++n) {
      const double* row = &values[(n + grid - m_max) % grid * grid];
      for (std::size_t x = 0; x < grid; ++x) turned[x * width + n] = row[x];
    }
    values.swap(turned);
  };
  turn(re), turn(im);
  transform_columns(re, im, grid, width);

  std::vector<double> correction(width);  // even in the frequency, to the bit
  for (std::size_t n = 0; n <= m_max; ++n)
    correction[m_max - n] = correction[m_max + n] =
        1 / kernel_transform(static_cast<double>(n) / static_cast<double>(grid));
  for (std::size_t m = 0; m <= m_max; ++m) {
    for (std::size_t n = 0; n < width; ++n) {
      const std::size_t k = m * width + n, opposite = (grid - m) % grid * width + (width - 1 - n);
      const double scale = correction[m + m_max] * correction[n] / 2;
      result.real[small].push_back((re[k] + re[opposite]) * scale);
      result.imaginary[small].push_back((im[k] - im[opposite]) * scale);
      result.real[big].push_back((im[k] + im[opposite]) * scale);
      result.imaginary[big].push_back((re[opposite] - re[k]) * scale);
    }
  }
  return result;
}

StructureFactor structure_factor(const DensityModes& modes, Group group) {
  StructureFactor factor{modes.modes, modes.spacing, {}};
  const bool with_small = group != Group::big, with_big = group != Group::small;
  const auto disks = static_cast<double>((with_small ? modes.disks[small] : 0) + (with_big ? modes.disks[big] : 0));
  for (std::size_t k = 0; k < modes.real[small].size(); ++k) {
    const double re = (with_small ? modes.real[small][k] : 0) + (with_big ? modes.real[big][k] : 0);
    const double im = (with_small ? modes.imaginary[small][k] : 0) + (with_big ? modes.imaginary[big][k] : 0);
    factor.values.push_back((re * re + im * im) / disks);
  }
  return factor;
}

double StructureFactor::at(int m, int n) const {
  if (m < 0) return at(-m, -n);
  return values[static_cast<std::size_t>(m) * static_cast<std::size_t>(2 * modes + 1) +
                static_cast<std::size_t>(n + modes)];
}

RingAverage ring_average(const StructureFactor& factor, double width) {
  struct Ring {
    double k = 0, value = 0, cosine = 0, sine = 0;
    std::uint64_t count = 0;
  };
  const double longest = factor.modes * factor.spacing * (1 + 1e-12);
  std::vector<Ring> rings(static_cast<std::size_t>(longest / width) + 1);
  for (int m = 0; m <= factor.modes; ++m) {
    for (int n = m > 0 ? -factor.modes : 1; n <= factor.modes; ++n) {
      const double k = factor.spacing * std::sqrt(static_cast<double>(m * m + n * n));
      if (k > longest) continue;
      Ring& ring = rings[static_cast<std::size_t>(k / width)];
      const double s = factor.at(m, n), c = factor.spacing * m / k, d = factor.spacing * n / k;
      // (c + i d)^6
      const double c2 = c * c - d * d, d2 = 2 * c * d;
      ring.k += k;
      ring.value += s;
      ring.cosine += s * c2 * (c2 * c2 - 3 * d2 * d2);
      ring.sine += s * d2 * (3 * c2 * c2 - d2 * d2);
      ++ring.count;
    }
  }
  RingAverage average;
  for (const Ring& ring : rings) {
    if (ring.count == 0) continue;
    const auto count = static_cast<double>(ring.count);
    const double sixfold = std::sqrt(ring.cosine * ring.cosine + ring.sine * ring.sine);
    average.wavenumber.push_back(ring.k / count);
    average.value.push_back(ring.value / count);
    average.anisotropy.push_back(ring.value > 0 ? sixfold / ring.value : 0);
    average.count.push_back(ring.count);
  }
  return average;
}

}  // namespace sandglass
