#include "sandglass/study/start.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/core/errors.h"

using namespace sandglass;

TEST_CASE("a start has the wanted disks, density, temperature, law and clocks") {
  Config config;
  config.system.particles = 200;
  config.system.packing_fraction = 0.3;
  config.prepare.method = PrepareMethod::insert;
  config.collision.restitution = 0.7;
  config.drive.temperature = 2;
  const State state = make_start(config);
  CHECK(state.size() == 200);
  CHECK(counts_of(config).big == 100);
  CHECK(packing_fraction(state) == doctest::Approx(0.3).epsilon(1e-12));
  CHECK(temperatures(state).all == doctest::Approx(2).epsilon(1e-12));
  CHECK(state.collision.restitution == 0.7);
  CHECK(state.epoch_length == 1024 * beat_of(config));
  CHECK(state.drive.frequency == 1 / beat_of(config));
  // Kicks at rate f per disk give it f <p^2> / (2 m) energy per time on average; collisions at rate omega take
  // (1 - eps^2) T / 2 per disk each (physics of the monodisperse estimate that the first guess uses, averaged over m).
  const double gain =
      state.drive.frequency * state.drive.amplitude * state.drive.amplitude * (1 + 1 / (1.43 * 1.43)) / 2;
  const double loss = (1 - 0.49) * 2 / 2 / beat_of(config);
  CHECK(gain == doctest::Approx(loss).epsilon(1e-12));
  for (const Disk& disk : state.disks) CHECK(std::isfinite(disk.next_kick));
}

TEST_CASE("a large system is calibrated with a smaller one of its kind, unless it comes from a file") {
  Config config;
  config.system.particles = 4'000'000;
  config.system.big_fraction = 1.0 / 3;  // 10^5 would not be whole disks of each species
  const Config calibrated = calibration_config(config);
  CHECK(calibrated.system.particles == 100'002);
  CHECK(beat_of(calibrated) == beat_of(config));
  config.system.particles = 300;
  CHECK(calibration_config(config).system.particles == 300);
  config.system.particles = 3'000'000;
  config.prepare.method = PrepareMethod::file;
  CHECK(calibration_config(config).system.particles == 3'000'000);
}

TEST_CASE("a start file that is not there is refused by name") {
  Config config;
  config.prepare.method = PrepareMethod::file;
  for (const char* file : {"/absent/start.h5", "/tmp"}) {
    config.prepare.file = file;
    CHECK_THROWS_WITH_AS(make_start(config), doctest::Contains(file), InputError);
  }
}
