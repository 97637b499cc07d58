#include "sandglass/study/calibrate.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

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

TEST_CASE("a calibration goes on from the state and the fields of a stopped one, and from no others") {
  Config config;
  config.system.particles = 100;
  config.system.packing_fraction = 0.3;
  config.prepare.method = PrepareMethod::insert;
  const State start = make_start(config);
  const CalibrationGoal goal{.beat = beat_of(config)};
  Calibrator whole(start, goal);
  for (int beat = 0; beat < 200; ++beat) whole.advance_one_beat(), whole.end_window();
  const State halfway = whole.simulation().state();
  const std::vector<Field> kept = whole.fields();
  // A new one, with field `name` set to `value`.
  const auto restored = [&](const std::string& name, double value) {
    Calibrator again(halfway, goal);
    const std::vector<Field> fields = again.fields();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto copy = [&]<class T>(T* target) {
        const T from = *std::get<T*>(kept[i].target);
        *target = fields[i].name == name ? static_cast<T>(value) : from;
      };
      if (auto* const* count = std::get_if<std::uint64_t*>(&fields[i].target)) copy(*count);
      if (auto* const* number = std::get_if<double*>(&fields[i].target)) copy(*number);
    }
    return again;
  };
  Calibrator again = restored("", 0);
  CHECK(again.valid());
  for (const char* count : {"beats", "window", "beats_in_window", "collisions_before", "frequencies_count", "done"})
    CHECK_MESSAGE(!restored(count, 1e9).valid(), count);
  for (const char* number : {"frequency", "amplitude", "temperature_sum", "frequencies_sum", "amplitudes_squares"})
    for (const double value : {std::nan(""), std::numeric_limits<double>::infinity(), -1.0})
      CHECK_MESSAGE(!restored(number, value).valid(), number);
  while (!whole.done()) whole.advance_one_beat(), whole.end_window();
  while (!again.done()) again.advance_one_beat(), again.end_window();
  CHECK(again.result().amplitude == whole.result().amplitude);
  CHECK(again.result().frequency == whole.result().frequency);
  CHECK(state_hash(again.simulation().state()) == state_hash(whole.simulation().state()));
}
