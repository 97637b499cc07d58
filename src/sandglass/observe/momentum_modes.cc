#include "sandglass/observe/momentum_modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sandglass/core/random.h"
#include "sandglass/observe/portable.h"

namespace sandglass {

std::vector<WaveShell> momentum_shells(double box_length, double longest) {
  std::vector<WaveShell> shells;
  for (double k = 2 * std::numbers::pi / box_length; k <= longest; k *= 1.25) {
    WaveShell shell = wave_shell(k, box_length);
    if (shells.empty() || shell.modes != shells.back().modes) shells.push_back(std::move(shell));
  }
  return shells;
}

namespace {

/// Real and imaginary part of sum_j v_j exp(-i k.r_j), for both components of the velocity.
struct Mode {
  double xr = 0, xi = 0, yr = 0, yi = 0;
};

SANDGLASS_WIDE Mode velocity_mode(const Snapshot& s, Range range, double kx, double ky) {
  Mode mode;
  std::array<double, block_size> cosine, sine, product;
  for (std::size_t begin = range.begin; begin < range.end; begin += block_size) {
    const std::size_t count = std::min(block_size, range.end - begin);
    // One array written to a loop: with four the compiler gives up to tell that they do not overlap what is read, and
    // goes disk by disk.
    for (std::size_t j = 0; j < count; ++j) cosine[j] = cosine_of_turns(kx * s.x[begin + j] + ky * s.y[begin + j]);
    for (std::size_t j = 0; j < count; ++j) sine[j] = cosine_of_turns(kx * s.x[begin + j] + ky * s.y[begin + j] - 0.25);
    auto sum = [&](const std::vector<double>& velocity, const std::array<double, block_size>& wave) {
      for (std::size_t j = 0; j < count; ++j) product[j] = velocity[begin + j] * wave[j];
      return ordered_sum({product.data(), count});
    };
    mode.xr += sum(s.vx, cosine), mode.xi += sum(s.vx, sine);
    mode.yr += sum(s.vy, cosine), mode.yi += sum(s.vy, sine);
  }
  return mode;
}

}  // namespace

MomentumStructure momentum_structure(const Snapshot& snapshot, const Population& population,
                                     const std::vector<WaveShell>& shells) {
  const auto& mass = population.mixture.mass;
  double total_mass = 0;
  for (const Species species : {small, big})
    total_mass += mass[species] * static_cast<double>(population.range(species).size());
  MomentumStructure structure;
  for (const WaveShell& shell : shells) {
    double transverse = 0, longitudinal = 0;
    for (const auto& [m, n] : shell.modes) {
      Mode sum;
      for (const Species species : {small, big}) {
        const Mode mode =
            velocity_mode(snapshot, population.range(species), m / population.box_length, n / population.box_length);
        sum.xr += mass[species] * mode.xr, sum.xi += mass[species] * mode.xi;
        sum.yr += mass[species] * mode.yr, sum.yi += mass[species] * mode.yi;
      }
      const double per_k = 1 / std::sqrt(static_cast<double>(m) * m + static_cast<double>(n) * n);
      const double ex = m * per_k, ey = n * per_k;
      const double lr = ex * sum.xr + ey * sum.yr, li = ex * sum.xi + ey * sum.yi;
      const double tr = ex * sum.yr - ey * sum.xr, ti = ex * sum.yi - ey * sum.xi;
      longitudinal += lr * lr + li * li;
      transverse += tr * tr + ti * ti;
    }
    const double share = static_cast<double>(shell.modes.size()) * total_mass;
    structure.transverse.push_back(transverse / share);
    structure.longitudinal.push_back(longitudinal / share);
  }
  return structure;
}

namespace {

/// Best a + b / (1 + k^2 xi^2) for a given xi.
struct Lorentzian {
  double b = 0, squares = 0;
};

template <class Value>
Lorentzian fit(const std::vector<double>& k, Value&& value, double xi) {
  double n = 0, mx = 0, my = 0;
  const auto shape = [&](double q) { return 1 / (1 + q * q * xi * xi); };
  for (std::size_t i = 0; i < k.size() && k[i] <= 1; ++i) n += 1, mx += shape(k[i]), my += value(i);
  mx /= n, my /= n;
  double sxx = 0, sxy = 0, syy = 0;
  for (std::size_t i = 0; i < k.size() && k[i] <= 1; ++i) {
    const double dx = shape(k[i]) - mx, dy = value(i) - my;
    sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
  }
  return {sxy / sxx, syy - sxy * sxy / sxx};
}

}  // namespace

Estimate velocity_correlation_length(const IntervalSeries& transverse, double box_length) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const auto shells = std::count_if(transverse.time.begin(), transverse.time.end(), [](double k) { return k <= 1; });
  if (transverse.intervals < 2 || shells < 5) return {};
  constexpr int steps = 200;
  const double longest = box_length / (2 * std::numbers::pi);
  const auto best = [&](std::size_t left_out) {
    double best_xi = 1;
    Lorentzian best_fit{0, std::numeric_limits<double>::infinity()};
    for (int step = 0; step <= steps; ++step) {
      const double xi = portable_exp(step * portable_log(longest) / steps);
      const Lorentzian trial = fit(
          transverse.time, [&](std::size_t i) { return transverse.mean(i, left_out); }, xi);
      if (trial.squares < best_fit.squares) best_fit = trial, best_xi = xi;
    }
    return std::pair{best_xi, best_fit.b};
  };
  const Estimate height = jackknife(transverse.intervals, [&](std::size_t left_out) { return best(left_out).second; });
  if (!(std::fabs(height.value) > 3 * height.error)) return {nothing, nothing};
  const Estimate xi = jackknife(transverse.intervals, [&](std::size_t left_out) { return best(left_out).first; });
  const bool inside = xi.value > 1.001 && xi.value < 0.999 * longest;  // ends are met to rounding
  return {xi.value, inside ? xi.error : nothing};
}

}  // namespace sandglass
