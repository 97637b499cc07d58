// The driven steady state: species temperatures and the shape of the velocity distribution.
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

namespace {

/// Time averages over the steady state, 25 collisions per disk in each of 40 blocks.
struct Steady {
  Average temperature, ratio, rate;  ///< T, T_s / T_b, and omega over that of the theory
};

Steady run_steady(const State& initial) {
  const double free_time = 1 / initial.drive.frequency;
  Simulation simulation(initial);
  simulation.run_until(100 * free_time);
  Steady steady;
  for (int block = 0; block < block_count; ++block) {
    constexpr int looks = 10;
    Temperatures sum;
    const Stretch seen = run_stretch(simulation, 25 * free_time, looks, [&] {
      const Temperatures now = temperatures(simulation.state());
      sum.all += now.all;
      sum.small += now.small;
      sum.big += now.big;
    });
    steady.temperature.add(sum.all / looks);
    steady.ratio.add(sum.small / sum.big);
    steady.rate.add(seen.rate * free_time);
  }
  return steady;
}

}  // namespace

TEST_CASE("species temperatures balance as kinetic theory says") {
  SUBCASE("dilute, single kicks: within 2 %") {
    // What the theory leaves out is the field of velocities that the kicks stir and collisions do not damp; it grows
    // with the density and with 1 - eps (1 % of T at eta = 0.03, 11 % at eta = 0.5 for eps = 0.8).
    for (const double restitution : {0.9, 0.8}) {
      CAPTURE(restitution);
      const State initial = [&] {
        State state = start(1.43, 2000, 0.03, 41);
        drive(state, DriveKind::single, restitution);
        return state;
      }();
      const auto theory = driven_steady_state(initial.mixture, 0.5, 0.03, restitution, 1);
      const Steady steady = run_steady(initial);
      CHECK(steady.temperature.error() < 0.005);
      CHECK(steady.temperature.sigmas_from(1, 0.02) < allowed_sigmas);
      CHECK(steady.rate.sigmas_from(1, 0.01) < allowed_sigmas);
      CHECK(steady.ratio.error() < 0.005);
      CHECK(steady.ratio.sigmas_from(theory.temperature[small] / theory.temperature[big], 0.01) < allowed_sigmas);
    }
  }
  SUBCASE("dense, kicks of nearest neighbours: within 5 %, and the small disks are the hotter ones") {
    State state = start(1.43, 2000, 0.5, 42);
    drive(state, DriveKind::pair, 0.9);
    const auto theory = driven_steady_state(state.mixture, 0.5, 0.5, 0.9, 1);
    const Steady steady = run_steady(state);
    CHECK(steady.temperature.sigmas_from(1, 0.05) < allowed_sigmas);
    CHECK(steady.rate.sigmas_from(1, 0.03) < allowed_sigmas);
    CHECK(steady.ratio.sigmas_from(theory.temperature[small] / theory.temperature[big], 0.05) < allowed_sigmas);
    CHECK(steady.ratio.mean() > 1 + allowed_sigmas * steady.ratio.error());
  }
}

TEST_CASE("nearest-neighbour kicks find big disks more often") {
  // Seen before: small disks are kicked at 0.92 to 0.95, big ones at 1.05 to 1.08 of the mean rate in dense fluids.
  State state = start(1.43, 2000, 0.6, 43);
  drive(state, DriveKind::pair, 0.9);
  const double free_time = 1 / state.drive.frequency;
  Simulation simulation(std::move(state));
  simulation.run_until(200 * free_time);
  const Tally& tally = simulation.tally();
  const auto of_small = static_cast<double>(tally.kicked[small]), of_big = static_cast<double>(tally.kicked[big]);
  CHECK(tally.kicked[small] + tally.kicked[big] == 2 * tally.kicks);
  CHECK(tally.kicks_without_partner == 0);
  // Every disk at rate f: N f t = 4 10^5 disks kicked, in pairs whose number is Poissonian.
  CHECK(std::fabs(of_small + of_big - 4e5) < allowed_sigmas * 2 * std::sqrt(2e5));
  const double share = 2 * of_small / (of_small + of_big);  // statistical error about 1 / sqrt(4 10^5) = 0.0016
  CHECK(share > 0.92);
  CHECK(share < 0.95);
}

TEST_CASE("white noise gives the velocity distribution its kurtosis") {
  for (const double restitution : {0.5, 0.9}) {
    CAPTURE(restitution);
    constexpr double kicks_per_collision = 8;
    State state = start(1, 2000, 0.01, 44);
    drive(state, DriveKind::single, restitution, kicks_per_collision);
    const double free_time = kicks_per_collision / state.drive.frequency;
    Simulation simulation(std::move(state));
    simulation.run_until(50 * free_time);
    Average kurtosis;
    for (int block = 0; block < block_count; ++block) {
      double square = 0, fourth = 0, count = 0;
      run_stretch(simulation, 8 * free_time, 4, [&] {
        const State now = simulation.state();
        const auto [px, py] = total_momentum(now);  // masses are 1
        for (const Disk& disk : now.disks) {
          const double vx = disk.vx - px / 2000, vy = disk.vy - py / 2000;
          square += vx * vx + vy * vy;
          fourth += (vx * vx + vy * vy) * (vx * vx + vy * vy);
          count += 1;
        }
      });
      kurtosis.add(fourth / count / (2 * square / count * square / count) - 1);
    }
    // Kicks are not infinitely small. Their own fourth moment adds (1 + delta) to the fourth moment that white noise
    // injects, delta = p^2 / (2 T) = (1 - eps^2) (omega / f) / 4, which makes 1 - 2 eps^2 in the formula
    // 1 - 2 eps^2 + 8 delta (and changes its denominator by 24 (1 - eps) delta, negligible here).
    const double delta = (1 - restitution * restitution) / kicks_per_collision / 4;
    const double expected = white_noise_kurtosis(restitution) * (1 + 8 * delta / (1 - 2 * restitution * restitution));
    // 320 000 velocities, two collisions apart: sigma = 1 / sqrt(3.2 10^5) = 0.0018. Allowed to the theory, which is
    // linear in a2: 0.002.
    CHECK(kurtosis.error() < 0.003);
    CHECK(kurtosis.sigmas_from(expected, 0.002) < allowed_sigmas);
  }
}
