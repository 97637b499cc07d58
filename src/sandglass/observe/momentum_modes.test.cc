#include "sandglass/observe/momentum_modes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "sandglass/core/random.h"
#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

struct System {
  Snapshot snapshot;
  Population population;
};

// Uniform points with Gaussian velocities of temperature 1.
System gas(std::size_t n, double box_length, std::uint64_t seed) {
  State state = scattered_disks(n, box_length, seed);
  draw_velocities(state, 1);
  Frame frame;
  make_frame(state, frame);
  System system{{}, population_of(state)};
  take_snapshot(frame, system.population, system.snapshot);
  return system;
}

}  // namespace

TEST_CASE("velocity structure factors equal the sums that define them") {
  const System system = gas(200, 30, 4);
  const auto shells = momentum_shells(30, 2);
  const MomentumStructure found = momentum_structure(system.snapshot, system.population, shells);
  for (std::size_t shell = 0; shell < shells.size(); ++shell) {
    double longitudinal = 0, transverse = 0, mass = 0;
    for (const auto& [m, n] : shells[shell].modes) {
      const double kx = 2 * std::numbers::pi / 30 * m, ky = 2 * std::numbers::pi / 30 * n, k = std::hypot(kx, ky);
      std::complex<double> jx = 0, jy = 0;
      mass = 0;
      for (std::size_t i = 0; i < 200; ++i) {
        const double mi = system.population.mixture.mass[i < system.population.small_count ? small : big];
        const auto phase = std::polar(mi, -(kx * system.snapshot.x[i] + ky * system.snapshot.y[i]));
        jx += system.snapshot.vx[i] * phase, jy += system.snapshot.vy[i] * phase, mass += mi;
      }
      longitudinal += std::norm((kx * jx + ky * jy) / k), transverse += std::norm((kx * jy - ky * jx) / k);
    }
    const double share = mass * static_cast<double>(shells[shell].modes.size());
    // Cosines are right to 1e-13, terms of order 1: 200 of them against a sum of order 200.
    CHECK(found.longitudinal[shell] == doctest::Approx(longitudinal / share).epsilon(1e-10));
    CHECK(found.transverse[shell] == doctest::Approx(transverse / share).epsilon(1e-10));
  }
}

TEST_CASE("independent velocities: T at every wavenumber, in both directions, and no correlation length") {
  const auto shells = momentum_shells(60, 2.5);
  IntervalSeries transverse;
  for (const WaveShell& shell : shells) transverse.time.push_back(shell.wavenumber);
  transverse.totals.resize(shells.size());
  std::vector<double> longitudinal(shells.size());
  constexpr int frames = 40;
  for (std::uint64_t seed = 0; seed < frames; ++seed) {
    const System system = gas(600, 60, seed);
    const MomentumStructure one = momentum_structure(system.snapshot, system.population, shells);
    ++transverse.intervals;
    for (std::size_t shell = 0; shell < shells.size(); ++shell) {
      transverse.means.push_back(one.transverse[shell]);
      transverse.totals[shell] += one.transverse[shell];
      longitudinal[shell] += one.longitudinal[shell];
    }
  }
  for (std::size_t shell = 0; shell < shells.size(); ++shell) {
    // |J|^2 is exponential: sigma 1 / sqrt(modes * frames), five of them.
    const double sigma = 1 / std::sqrt(static_cast<double>(shells[shell].modes.size()) * frames);
    CHECK(std::fabs(transverse.mean(shell) - 1) < 5 * sigma);
    CHECK(std::fabs(longitudinal[shell] / frames - 1) < 5 * sigma);
  }
  CHECK(std::isnan(velocity_correlation_length(transverse, 60).value));
}

/// Twenty intervals of a Lorentzian of correlation length `xi`, with noise of 2 % of T, in a box of side 400.
IntervalSeries lorentzian(double xi) {
  IntervalSeries series;
  for (const WaveShell& shell : momentum_shells(400, 2.5)) series.time.push_back(shell.wavenumber);
  series.totals.resize(series.time.size());
  series.intervals = 20;
  for (std::size_t i = 0; i < series.intervals; ++i) {
    for (std::size_t k = 0; k < series.time.size(); ++k) {
      const auto words = random_words(9, Stream::probe, i, k);
      const double q = series.time[k], noise = 0.02 * gaussian_pair(words[0], words[1])[0];
      series.means.push_back(1 - 0.4 / (1 + q * q * xi * xi) + noise);
      series.totals[k] += series.means.back();
    }
  }
  return series;
}

TEST_CASE("the correlation length of a given Lorentzian is found, with its error") {
  const Estimate xi = velocity_correlation_length(lorentzian(7), 400);
  CHECK(xi.error < 0.5);
  // The grid of trial lengths is as fine as 2 %.
  CHECK(std::fabs(xi.value - 7) < 4.5 * xi.error + 0.02 * 7);
}

TEST_CASE("a correlation length beyond the box, or below a radius, has no error") {
  const Estimate longest = velocity_correlation_length(lorentzian(100), 400),
                 shortest = velocity_correlation_length(lorentzian(0.3), 400);
  CHECK(longest.value == doctest::Approx(400 / (2 * std::numbers::pi)));
  CHECK(shortest.value == doctest::Approx(1));
  CHECK(std::isnan(longest.error));
  CHECK(std::isnan(shortest.error));
}
