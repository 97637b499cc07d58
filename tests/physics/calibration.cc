// The calibrated drive holds the temperature that was asked for.
#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/study/calibrate.h"
#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

namespace {

/// T averaged over `collisions` per disk, with the drive frozen after calibration and a fresh Gaussian start.
void check_temperature(double eta, double restitution, double collisions) {
  CAPTURE(eta);
  CAPTURE(restitution);
  constexpr std::size_t particles = 4000;
  State state = start(1.43, particles, eta, 61);
  drive(state, DriveKind::pair, restitution);
  const double beat = mean_free_time(state.mixture, 0.5, eta, 1);
  state.collision.collapse = CollapsePolicy::tc;
  state.collision.collapse_time = 2e-6 * beat;
  CalibrationGoal goal;  // T = 1 and f_Dr = omega
  goal.beat = beat;
  const Calibration found = calibrate(state, goal);
  CHECK(found.converged);
  state.drive.frequency = found.frequency;
  state.drive.amplitude = found.amplitude;
  start_kick_clocks(state);

  const double free_time = 1 / found.frequency;
  Simulation simulation(std::move(state));
  simulation.run_until(100 * free_time);
  double sum = 0;
  const int looks = static_cast<int>(collisions / 2);
  const Stretch seen =
      run_stretch(simulation, collisions * free_time, looks, [&] { sum += temperatures(simulation.state()).all; });
  const double temperature = sum / looks;
  // The energy relaxes in tau = 4 / (3 (1 - eps^2)) collisions per disk and scatters by T / sqrt(N), so that a mean
  // over s collisions has the relative error sqrt(2 tau / (N s)): 0.13 % for eps = 0.9 (s = 2000) and 0.09 % for eps =
  // 0.5 (s = 1000). Calibration knows T to 0.2 %. 0.24 % together: 1 % is 4.2 sigma.
  CHECK(std::fabs(temperature - 1) < 0.01);
  // Kicks come at the rate of collisions: the rate goes as sqrt(T), known to half as much, and its own noise is
  // smaller.
  CHECK(std::fabs(seen.rate * free_time - 1) < 0.01);
}

}  // namespace

TEST_CASE("T = 1 on time average, eps = 0.5") {
  for (const double eta : {0.1, 0.5, 0.75}) check_temperature(eta, 0.5, 1000);
}

TEST_CASE("T = 1 on time average, eps = 0.9") {
  for (const double eta : {0.1, 0.5, 0.75}) check_temperature(eta, 0.9, 2000);
}
