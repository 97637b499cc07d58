#include "sandglass/study/run_place.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/study/start.h"

using namespace sandglass;

namespace {

Config small_config() {
  Config config;
  config.system.particles = 200;
  config.system.packing_fraction = 0.3;
  config.prepare.method = PrepareMethod::insert;
  return config;
}

/// A run of small_config(), 40 beats of which are done: 8 of equilibration and 32 of 50 that are measured.
struct Halfway {
  Config config = small_config();
  double beat = beat_of(config);
  State state = make_start(config);
  RunPlace place{.beats = 40, .measuring = 1, .first_beat = 8, .measured_beats = 50, .marks = {4, 8, 4.5, 9}};

  Halfway() {
    Simulation simulation(state);
    simulation.run_until(40 * beat);
    state = simulation.state();
  }
};

}  // namespace

TEST_CASE("a state and a place that contradict the configuration or each other are refused") {
  const Halfway good;
  CHECK(message_of<InputError>([&] { check_place(good.place, good.state, good.config, good.beat); }).empty());
  const std::vector<std::function<void(Halfway&)>> spoil{
      [](Halfway& h) { h.config.system.particles = 202; },
      [](Halfway& h) { h.config.system.size_ratio = 1.5; },
      [](Halfway& h) { h.config.system.big_fraction = 0.4; },
      [](Halfway& h) { h.config.system.packing_fraction = 0.31; },
      [](Halfway& h) { h.config.collision.restitution = 0.5; },
      [](Halfway& h) { h.config.run.seed = 99; },
      [](Halfway& h) { h.config.drive.kind = DriveKind::single; },
      [](Halfway& h) { h.state.box_length *= 1.01; },
      [](Halfway& h) { h.state.epoch_length *= 2; },
      [](Halfway& h) { h.state.now *= 1.001; },
      [](Halfway& h) { h.beat *= 1.001; },
      [](Halfway& h) { h.place.beats = 41; },
      [](Halfway& h) { h.place.beats = std::numeric_limits<std::uint64_t>::max(); },
      [](Halfway& h) { h.place.calibrating = 1; },
      [](Halfway& h) { h.place.calibrating = 2; },
      [](Halfway& h) { h.place.measuring = 2; },
      [](Halfway& h) { h.place.measuring = 0; },
      [](Halfway& h) { h.place.first_beat = 41; },
      [](Halfway& h) { h.place.measured_beats = 31; },
      [](Halfway& h) { h.place.measured_beats = 0; },
      [](Halfway& h) { h.place.marks.late_beats = 0; },
      [](Halfway& h) { h.place.marks.late_beats = 9; },
      [](Halfway& h) { h.place.marks.late_beats = 64, h.place.marks.early_beats = 32; },
      [](Halfway& h) { h.place.marks.early_beats = 8; },
      [](Halfway& h) { h.place.marks.early_collisions = std::nan(""); },
      [](Halfway& h) { h.place.marks.late_collisions = std::numeric_limits<double>::infinity(); },
      [](Halfway& h) { h.place.marks.late_collisions = 1; },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    CAPTURE(i);
    Halfway spoilt = good;
    spoil[i](spoilt);
    const std::string message =
        message_of<InputError>([&] { check_place(spoilt.place, spoilt.state, spoilt.config, spoilt.beat); });
    CHECK(message.find("the checkpoint is damaged") == 0);
  }
}

TEST_CASE("a plan is that of the measured beats") {
  const Halfway run;
  MeasurementPlan plan;
  plan.start = 8 * run.beat;
  plan.intervals = 7;
  plan.interval_length = 50 * run.beat / 7;
  CHECK(message_of<InputError>([&] { check_place(run.place, plan, run.beat); }).empty());
  MeasurementPlan other = plan;
  other.start = 9 * run.beat;
  CHECK_THROWS_AS(check_place(run.place, other, run.beat), InputError);
  other = plan;
  other.interval_length *= 1.001;
  CHECK_THROWS_AS(check_place(run.place, other, run.beat), InputError);
}
