// What collisions and kicks must keep, and what they must change: energy, momentum, free cooling.
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

TEST_CASE("elastic undriven disks keep their energy to rounding") {
  for (const double eta : {0.05, 0.6}) {
    State state = start(1.43, 1000, eta, 31);
    const double before = kinetic_energy(state), free_time = mean_free_time(state.mixture, 0.5, eta, 1);
    Simulation simulation(std::move(state));
    simulation.run_until(1000 * free_time);
    CHECK(simulation.tally().collisions() > 400'000);
    CHECK(simulation.tally().kicks == 0);
    const double after = kinetic_energy(simulation.state());
    // A collision makes about ten roundings of 2^-53 of the energy 2 T of the pair, 2e-15 in all. As a random walk of
    // 5 10^5 steps that is 1.6e-12, or 1.6e-15 of N T; errors of one sign would make 1e-12. In between, at the
    // geometric mean, lies the bound.
    CHECK(std::fabs(after / before - 1) < 4e-14);
  }
}

TEST_CASE("energy is what was injected less what was dissipated") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::single})
    for (const double eta : {0.1, 0.7}) {
      State state = start(1.43, 500, eta, 32);
      drive(state, kind, 0.7);
      const double before = kinetic_energy(state), free_time = 1 / state.drive.frequency;
      Simulation simulation(std::move(state));
      simulation.run_until(200 * free_time);
      const Tally& tally = simulation.tally();
      CHECK(tally.collisions() > 40'000);
      CHECK(tally.kicks > 20'000);
      CHECK(tally.dissipated.value() > 10 * before);
      // Every term is rounded to 2^-44 (uniformly: 1.6e-14 rms) and the energies themselves to 1e-15; 10^5 to 2 10^5
      // events walk 450 times that, 7e-12 rms.
      const double expected = before + tally.injected.value() - tally.dissipated.value();
      CHECK(std::fabs(kinetic_energy(simulation.state()) - expected) < 4e-11);
    }
}

TEST_CASE("pair kicks keep the total momentum to rounding") {
  for (const double eta : {0.1, 0.7}) {
    State state = start(1.43, 1000, eta, 33);
    drive(state, DriveKind::pair, 0.7);
    const double free_time = 1 / state.drive.frequency;
    Simulation simulation(std::move(state));
    simulation.run_until(200 * free_time);
    CHECK(simulation.tally().kicks > 80'000);
    // Collision and kick round four components to 2^-53 of 1 to 4: 2e-16 rms. 2 10^5 events walk 450 times that, 1e-13.
    // The exact sum rounds each of 1000 terms to 2^-44, 1.6e-14 rms, which makes 5.2e-13, and 4.5 sigma of it are
    // 2.4e-12. One kick not given back would be 0.3.
    const auto momentum = total_momentum(simulation.state());
    CHECK(std::fabs(momentum[0]) < 2.4e-12);
    CHECK(std::fabs(momentum[1]) < 2.4e-12);
  }
}

TEST_CASE("single kicks make the total momentum a random walk of variance N f p^2 t") {
  State state = start(1.43, 100, 0.2, 34);
  drive(state, DriveKind::single, 0.8);
  const double kick_variance = state.drive.amplitude * state.drive.amplitude, frequency = state.drive.frequency;
  constexpr int steps = 8000;
  const double step = 1 / frequency;
  Simulation simulation(std::move(state));
  std::array<double, 2> previous{};
  double squares = 0, consecutive = 0;
  std::array<double, 2> last_change{};
  for (int k = 1; k <= steps; ++k) {
    simulation.run_until(k * step);
    const auto momentum = total_momentum(simulation.state());
    for (int axis = 0; axis < 2; ++axis) {
      const double change = momentum[axis] - previous[axis];
      squares += change * change;
      consecutive += change * last_change[axis];
      last_change[axis] = change;
    }
    previous = momentum;
  }
  // Each step is a sum of 100 Poisson kicks: a variance of 2 x 8000 nearly Gaussian terms is known to
  // sqrt((2 + 3/100) / 16000) = 1.13 %, the product of neighbours to 1 / sqrt(16000) = 0.8 % of the variance.
  const double variance = 100 * kick_variance * frequency * step;
  CHECK(std::fabs(squares / (2 * steps) / variance - 1) < allowed_sigmas * 0.0113);
  CHECK(std::fabs(consecutive / (2 * steps) / variance) < allowed_sigmas * 0.008);
  // The number of kicks is Poissonian: 8 10^5 of them, known to 0.11 %.
  const double kicks = static_cast<double>(simulation.tally().kicks);
  CHECK(std::fabs(kicks - 100.0 * steps) < allowed_sigmas * std::sqrt(100.0 * steps));
}

TEST_CASE("free cooling follows Haff's law") {
  // T = T_0 / (1 + t / tau)^2. Boxes of 200 disks are too small for the vortices that a large system would develop
  // (their least size is about 2 pi mean free paths / sqrt(1 - eps^2) = 60 radii; L = 56), and 80 independent ones give
  // the statistics. Relative velocities are those of N/(N-1) T and pairs are (N-1)/N as many, which makes
  // sqrt(N/(N-1)) in the cooling rate.
  constexpr int boxes = 80;
  constexpr double particles = 200, eta = 0.2, restitution = 0.98;
  const Mixture mixture = mixture_of(1);
  const double tau =
      haff_time(restitution, collision_rate(mixture, 0.5, eta, 1)) * std::sqrt((particles - 1) / particles);
  std::array<Average, 4> slowing;  // (T_0 / T)^(1/2) at t / tau = 0.5, 1, 1.5, 2
  for (int box = 0; box < boxes; ++box) {
    State state = start(1, static_cast<std::size_t>(particles), eta, 3500 + box);
    state.collision.restitution = restitution;
    Simulation simulation(std::move(state));
    for (std::size_t k = 0; k < slowing.size(); ++k) {
      simulation.run_until(0.5 * static_cast<double>(k + 1) * tau);
      slowing[k].add(1 / std::sqrt(temperatures(simulation.state()).all));
    }
  }
  for (std::size_t k = 0; k < slowing.size(); ++k) {
    // Linear in time. Allowed: 3 a2 / 16 = 0.2 % of the slope for the shape of the velocity distribution, 0.1 % for the
    // contact value, 0.5 % for velocities correlated by earlier collisions.
    const double expected = 1 + 0.5 * static_cast<double>(k + 1);
    CHECK(slowing[k].error() < 0.005 * expected);
    CHECK(slowing[k].sigmas_from(expected, 0.008 * (expected - 1)) < allowed_sigmas);
  }
}
