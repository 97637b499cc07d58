// How single disks move: first decay of velocities, free flight, diffusion, the shape of displacements.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

namespace {

/// Means over the disks of one species: dr^2, v.v' and v^2 between two frames.
struct Change {
  double square_displacement = 0, velocity_product = 0, square_velocity = 0;
};

std::array<Change, 2> compare(const State& disks, const Frame& from, const Frame& to) {
  std::array<Change, 2> change;
  std::array<double, 2> count{};
  for (std::size_t id = 0; id < from.size(); ++id) {
    auto& sum = change[disks.disks[id].species];
    const double dx = to.x[id] - from.x[id], dy = to.y[id] - from.y[id];
    sum.square_displacement += dx * dx + dy * dy;
    sum.velocity_product += from.vx[id] * to.vx[id] + from.vy[id] * to.vy[id];
    sum.square_velocity += from.vx[id] * from.vx[id] + from.vy[id] * from.vy[id];
    ++count[disks.disks[id].species];
  }
  for (int i = 0; i < 2; ++i)
    for (double* sum : {&change[i].square_displacement, &change[i].velocity_product, &change[i].square_velocity})
      *sum /= count[i];
  return change;
}

/// The value at lag 0 of what is known at one, two and three steps: exact for parabolas.
double extrapolate(const std::array<double, 3>& at) { return 3 * at[0] - 3 * at[1] + at[2]; }

/// Elastic disks in equilibrium that from one moment on collide with `restitution`: how their velocities start to
/// decay, and that they fly freely before. At that moment nothing is correlated yet, so the decay is exact in the
/// measured collision rates, at any density. (In a driven steady state it is not: kicks correlate the velocities of
/// disks about to collide, by several per cent at restitution 0.5.)
void check_first_steps(double eta, double restitution, std::uint64_t seed) {
  const State initial = start(1.43, 2000, eta, seed);
  const double free_time = mean_free_time(initial.mixture, 0.5, eta, 1), step = free_time / 10;
  Simulation equilibrium(initial);
  equilibrium.run_until(100 * free_time);
  std::array<Average, 2> decay_ratio, flight_ratio;
  for (int block = 0; block < block_count; ++block) {
    std::array<std::array<double, 3>, 2> decay{}, flight{};  // [species][lag]
    std::array<double, 2> square_velocity{};
    CollisionRates measured;
    measured.pair = run_stretch(equilibrium, 25 * free_time, 20, [&] {
                      State state = equilibrium.state();
                      state.collision.restitution = restitution;
                      Simulation switched(state);
                      const auto frames = record(switched, step, 4);
                      for (int lag = 1; lag <= 3; ++lag) {
                        const auto change = compare(initial, frames[0], frames[lag]);
                        for (int i = 0; i < 2; ++i) {
                          decay[i][lag - 1] += (change[i].square_velocity - change[i].velocity_product) / (lag * step);
                          flight[i][lag - 1] += change[i].square_displacement / (lag * step * lag * step);
                          square_velocity[i] += change[i].square_velocity / 3;
                        }
                      }
                    }).rates;
    const auto expected = velocity_decay_rates(initial.mixture, measured, restitution);
    for (int i = 0; i < 2; ++i) {
      decay_ratio[i].add(extrapolate(decay[i]) / square_velocity[i] / expected[i]);
      flight_ratio[i].add(extrapolate(flight[i]) / square_velocity[i]);
    }
  }
  for (int i = 0; i < 2; ++i) {
    CAPTURE(i);
    // 800 origins, 2000 disks, a collision each ten steps: 8 10^4 collisions per species, and the extrapolation makes
    // their noise (0.35 %) about four times larger. With e^-x, x = 1/10 to 1/7, for the decay it leaves out
    // 6 x^3 / 24 < 8e-4, and 6 x^3 / 60 < 3e-4 of the free flight; 1/N for the momentum that is zero.
    CHECK(decay_ratio[i].error() < 0.02);
    CHECK(decay_ratio[i].sigmas_from(1, 8e-4 + 1.0 / 2000) < allowed_sigmas);
    CHECK(flight_ratio[i].sigmas_from(1, 3e-4) < allowed_sigmas);
  }
}

}  // namespace

TEST_CASE("velocities first decay as collisions turn them, and disks fly freely before") {
  SUBCASE("elastic") { check_first_steps(0.5, 1, 21); }
  SUBCASE("inelastic") { check_first_steps(0.5, 0.5, 22); }
}

TEST_CASE("free flight has the speed of the temperature") {
  // Equilibrium shares the energy equally: <dr^2> / t^2 = 2 T / m at t -> 0 with T = 1 for both species, less m_i / M
  // of it for the momentum that is zero: 1/N. T_s scatters by 1 / sqrt(2 N_s) = 2.2 % and renews itself in a few
  // collisions, so that 40 blocks of 10 collisions per disk give about 0.2 %.
  const State initial = start(1.43, 2000, 0.3, 23);
  const double free_time = mean_free_time(initial.mixture, 0.5, 0.3, 1);
  Simulation simulation(initial);
  simulation.run_until(50 * free_time);
  std::array<Average, 2> temperature;
  for (int block = 0; block < block_count; ++block) {
    std::array<double, 2> mean{};
    for (int part = 0; part < 10; ++part) {
      const double step = free_time / 1000;  // collisions take less than 1 / 3000 of the square displacement
      const auto frames = record(simulation, step, 2);
      const auto change = compare(initial, frames[0], frames[1]);
      for (int i = 0; i < 2; ++i)
        mean[i] += change[i].square_displacement / (step * step) * initial.mixture.mass[i] / 2 / 10;
      simulation.run_until(simulation.time() + free_time);
    }
    for (int i = 0; i < 2; ++i) temperature[i].add(mean[i]);
  }
  for (int i = 0; i < 2; ++i) {
    CHECK(temperature[i].error() < 0.005);
    CHECK(temperature[i].sigmas_from(1, 1e-3 + 1.0 / 1000) < allowed_sigmas);
  }
}

TEST_CASE("dilute elastic disks diffuse as Enskog says") {
  // D = d MSD / dt / 4 between 10 and 20 collisions per disk: the velocity's memory e^-s is gone, and the long-time
  // tail (4 % per decade of time at eta = 0.05, so 0.8 % here) is still small: 1 % is allowed for it.
  const double eta = 0.01;
  const State initial = start(1, 1000, eta, 24);
  const double free_time = mean_free_time(initial.mixture, 0.5, eta, 1);
  Simulation simulation(initial);
  simulation.run_until(50 * free_time);
  Average diffusion;
  for (int block = 0; block < block_count; ++block) {
    const auto frames = record(simulation, 10 * free_time, 12);
    double difference = 0;
    for (std::size_t k = 0; k < 10; ++k)
      for (int i = 0; i < 2; ++i)
        difference += compare(initial, frames[k], frames[k + 2])[i].square_displacement -
                      compare(initial, frames[k], frames[k + 1])[i].square_displacement;
    diffusion.add(difference / (2 * 10) / (4 * 10 * free_time));
  }
  const double enskog = enskog_diffusion(initial.mixture, eta, 1);
  // 40 x 5 independent origins of 1000 disks; the difference of MSD scatters by about twice itself: 0.45 %.
  CHECK(diffusion.error() < 0.006 * enskog);
  CHECK(diffusion.sigmas_from(enskog, 0.01 * enskog) < allowed_sigmas);
}

TEST_CASE("displacements of dilute driven disks are Gaussian at all times") {
  // S_inc(k, t) = <cos k.dr> against exp(-k^2 MSD / 4), per species. Between free flight and diffusion a dilute gas has
  // a non-Gaussian parameter alpha_2 of at most 0.06 or so, which changes S_inc by alpha_2 / 2 (x^2 e^-x, at most
  // 0.54), x = k^2 MSD / 4: 0.016. A cage makes alpha_2 of order 1.
  State initial = start(1.43, 1000, 0.1, 25);
  drive(initial, DriveKind::pair, 0.9);
  const double free_time = 1 / initial.drive.frequency;
  Simulation simulation(initial);
  simulation.run_until(100 * free_time);
  const auto frames = record(simulation, free_time / 4, 1000);
  double worst = 0, least = 1;
  for (std::size_t lag = 1; lag <= 256; lag *= 4) {
    for (const double k : {0.05, 0.1, 0.2, 0.5, 3.0}) {
      std::array<double, 2> cosine{}, square{}, pairs{};
      for (std::size_t origin = 0; origin + lag < frames.size(); origin += 16)
        for (std::size_t id = 0; id < initial.size(); ++id) {
          const Species species = initial.disks[id].species;
          const double dx = frames[origin + lag].x[id] - frames[origin].x[id];
          const double dy = frames[origin + lag].y[id] - frames[origin].y[id];
          cosine[species] += (std::cos(k * dx) + std::cos(k * dy)) / 2;
          square[species] += dx * dx + dy * dy;
          pairs[species] += 1;
        }
      for (int i = 0; i < 2; ++i) {
        const double scattering = cosine[i] / pairs[i], gaussian = std::exp(-k * k * square[i] / pairs[i] / 4);
        worst = std::max(worst, std::fabs(scattering - gaussian));
        least = std::min(least, gaussian);
      }
    }
  }
  // 47 to 62 origins of 500 disks, two directions: the cosines scatter by 0.7 at most, 0.003 at the longest lag, where
  // successive origins overlap four times and count as one: 0.006, or 0.025 with 4.5 sigma. Added to 0.016 in squares.
  CHECK(worst < 0.03);
  CHECK(least < 0.01);  // the whole decay has been seen
}
