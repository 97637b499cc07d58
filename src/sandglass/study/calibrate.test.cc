#include "sandglass/study/calibrate.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/dynamics/simulation.h"
#include "sandglass/study/start.h"

using namespace sandglass;

TEST_CASE("the calibrated drive holds the wanted temperature at the collision rate") {
  Config config;
  config.system.particles = 2000;
  config.system.packing_fraction = 0.4;
  config.prepare.method = PrepareMethod::insert;
  config.collision.restitution = 0.8;
  config.drive.temperature = 1.5;
  State state = make_start(config);
  const double beat = beat_of(config);
  const Calibration found = calibrate(state, {.temperature = 1.5, .beat = beat});
  CHECK(found.converged);
  state.drive.frequency = found.frequency;
  state.drive.amplitude = found.amplitude;
  start_kick_clocks(state);
  Simulation simulation(state);
  simulation.run_until(100 * beat);
  const std::uint64_t before = simulation.tally().collisions();
  double sum = 0;
  constexpr int samples = 300;
  for (int i = 1; i <= samples; ++i) {
    simulation.run_until((100 + 2 * i) * beat);
    sum += temperatures(simulation.state()).all;
  }
  // sigma(T mean)/T = sqrt(2 tau / (N W)), tau = 4/(3 (1 - eps^2)) = 3.7 collisions per disk, W = 600: 0.25 %, and
  // calibration's own 0.2 %: 0.32 % together. 4.5 sigma.
  CHECK(sum / samples == doctest::Approx(1.5).epsilon(0.0144));
  const double rate = 2.0 * static_cast<double>(simulation.tally().collisions() - before) / (2000 * 600 * beat);
  // The rate follows sqrt(T), and its own noise is smaller: 1 % allows for both.
  CHECK(rate == doctest::Approx(found.frequency).epsilon(0.01));
}
