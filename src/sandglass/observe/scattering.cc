#include "sandglass/observe/scattering.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/observe/portable.h"

namespace sandglass {

double WaveShell::squared(std::size_t mode, double box_length) const {
  const double unit = 2 * std::numbers::pi / box_length;
  const auto [m, n] = modes[mode];
  return unit * unit * (static_cast<double>(m) * m + static_cast<double>(n) * n);
}

namespace {

// The vectors of length^2 `square` in units of (2 pi / L)^2, of +k and -k the one with m > 0 or m = 0 < n.
std::vector<std::array<int, 2>> vectors_of(std::int64_t square) {
  std::vector<std::array<int, 2>> vectors;
  const auto reach = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
  for (std::int64_t m = 0; m <= reach; ++m) {
    const std::int64_t rest = square - m * m;
    const auto n = static_cast<std::int64_t>(std::llround(std::sqrt(static_cast<double>(rest))));
    if (n * n != rest) continue;
    vectors.push_back({static_cast<int>(m), static_cast<int>(n)});
    if (m > 0 && n > 0) vectors.push_back({static_cast<int>(m), static_cast<int>(-n)});
  }
  return vectors;
}

}  // namespace

WaveShell wave_shell(double wavenumber, double box_length) {
  if (!(wavenumber > 0)) throw InputError("A wavenumber must be positive; give observe.wavenumbers in 1/R_s.");
  constexpr std::size_t enough = 4, most = 6;
  constexpr double spread = 0.05;
  const double unit = 2 * std::numbers::pi / box_length;
  const double wanted = wavenumber / unit;
  if (!(wanted <= most_waves))
    throw InputError("A wavenumber is too large for the box; lower observe.wavenumbers, which are in 1/R_s.");
  // All lengths |k|^2 / unit^2 worth a look: within the spread of the wanted one, and the nearest ones of a small box.
  // Every few whole numbers are a sum of two squares; beyond `far` from the wanted one none is needed.
  constexpr double far = 10000;
  const double lowest = (wanted - 1) * (wanted - 1) * (wanted > 1), highest = (wanted + 1) * (wanted + 1);
  const auto low = static_cast<std::int64_t>(std::max({1.0, std::floor(lowest), std::floor(wanted * wanted - far)}));
  const auto high = static_cast<std::int64_t>(std::ceil(std::min(highest, wanted * wanted + far)));
  std::vector<std::int64_t> squares;
  for (std::int64_t square = low; square <= high; ++square) squares.push_back(square);
  auto distance = [&](std::int64_t square) { return std::fabs(std::sqrt(static_cast<double>(square)) - wanted); };
  std::stable_sort(squares.begin(), squares.end(), [&](auto a, auto b) { return distance(a) < distance(b); });

  WaveShell shell;
  double nearest = 0, sum = 0;
  for (const std::int64_t square : squares) {
    const auto vectors = vectors_of(square);
    const double length = std::sqrt(static_cast<double>(square));
    if (vectors.empty() || shell.modes.size() + vectors.size() > most) continue;
    if (nearest > 0 && std::fabs(length - nearest) > spread * nearest) continue;
    if (nearest == 0) nearest = length;
    for (const auto& vector : vectors) shell.modes.push_back(vector);
    sum += length * static_cast<double>(vectors.size());
    if (shell.modes.size() >= enough) break;
  }
  shell.wavenumber = unit * sum / static_cast<double>(shell.modes.size());
  return shell;
}

// Most of the time of sampling goes here.
SANDGLASS_WIDE void add_scattering(const Snapshot& origin, const Snapshot& now, Range range, const WaveShell& shell,
                                   double box_length, ExactSum& sum) {
  const double per_length = 1 / box_length;
  const double weight = 1 / static_cast<double>(shell.modes.size());
  std::array<double, block_size> dx, dy, cosines;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    for (std::size_t j = 0; j < count; ++j) {
      dx[j] = (now.x[begin + j] - origin.x[begin + j]) * per_length;
      dy[j] = (now.y[begin + j] - origin.y[begin + j]) * per_length;
      cosines[j] = 0;
    }
    for (const auto& [m, n] : shell.modes) {
      const double kx = m, ky = n;
      for (std::size_t j = 0; j < count; ++j) cosines[j] += cosine_of_turns(kx * dx[j] + ky * dy[j]);
    }
    sum.add(weight * ordered_sum({cosines.data(), count}));
  }
}

GaussianApproximation gaussian_approximation(const WaveShell& shell, double box_length, double mean_square) {
  GaussianApproximation result;
  for (std::size_t mode = 0; mode < shell.modes.size(); ++mode) {
    const double k2 = shell.squared(mode, box_length);
    const double value = portable_exp(-k2 * mean_square / 4);
    result.value += value;
    result.derivative -= k2 / 4 * value;
  }
  const auto count = static_cast<double>(shell.modes.size());
  return {result.value / count, result.derivative / count};
}

}  // namespace sandglass
