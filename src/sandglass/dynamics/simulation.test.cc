#include "sandglass/dynamics/simulation.h"

#include <doctest/doctest.h>

#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/random_state.test.h"

using namespace sandglass;

TEST_CASE("elastic and undriven: energy, momentum and order of events are kept, disks stay apart") {
  RandomSystem system;
  system.particles = 500;
  system.packing_fraction = 0.5;
  system.restitution = 1;
  const State start = random_state(system);
  Simulation simulation(start);
  std::vector<Event> events;
  simulation.set_event_log(&events);
  simulation.run_until(50);
  const State end = simulation.state();
  CHECK(events.size() > 20000);
  std::size_t epochs = 0;
  for (std::size_t i = 1; i < events.size(); ++i) {
    if (events[i].time < events[i - 1].time - 4)
      ++epochs;  // times are counted anew
    else
      CHECK(events[i].time >= events[i - 1].time - 1e-14);  // a late event: the last digit
  }
  CHECK(epochs == 50 / 5 - 1);  // the one at 50 comes after the last event
  // Each collision rounds a few numbers of order 1 at 1e-16; 1e5 of them add up like a random walk to 1e-13.
  CHECK(kinetic_energy(end) == doctest::Approx(kinetic_energy(start)).epsilon(1e-11));
  CHECK(std::fabs(total_momentum(end)[0]) < 1e-10);
  CHECK(deepest_overlap(end) < 1e-12);
  CHECK(simulation.tally().dissipated.value() == 0);
}

TEST_CASE("the tally balances the energy of a driven run") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::single}) {
    RandomSystem system;
    system.particles = 300;
    system.drive = {.kind = kind, .frequency = 2, .amplitude = 0.3};
    const State start = random_state(system);
    Simulation simulation(start);
    simulation.run_until(40);
    const Tally& tally = simulation.tally();
    CHECK(tally.kicks > 5000);
    const double change = kinetic_energy(simulation.state()) - kinetic_energy(start);
    // Quantum of the sums 6e-14, some 1e4 terms in each.
    CHECK(tally.injected.value() - tally.dissipated.value() == doctest::Approx(change).epsilon(1e-9));
    if (kind == DriveKind::pair) CHECK(std::fabs(total_momentum(simulation.state())[0]) < 1e-10);
  }
}

TEST_CASE("states that cannot be run exactly are refused") {
  RandomSystem system;
  const State good = random_state(system);
  auto refused = [&](auto&& spoil) {
    State bad = good;
    spoil(bad);
    CHECK_THROWS_AS(Simulation{bad}, InputError);
  };
  CHECK_NOTHROW(Simulation{good});
  refused([](State& s) { s.disks[1].x = s.disks[0].x, s.disks[1].y = s.disks[0].y + 1; });
  refused([](State& s) { s.disks[1].x = std::nan(""); });
  refused([](State& s) { s.disks[1].vx = HUGE_VAL; });
  refused([](State& s) { s.disks[1].y = s.box_length; });
  refused([](State& s) { s.mixture.radius[0] = -1; });
  refused([](State& s) { s.box_length = 11; });
  refused([](State& s) { s.disks.resize(1); });
  refused([](State& s) { s.collision.restitution = 1.1; });
  refused([](State& s) { s.epoch_length = 0; });
  refused([](State& s) { s.drive = {.kind = DriveKind::pair, .frequency = 0}; });
}

TEST_CASE("a frame equals that of the stored state") {
  const State start = random_state({});
  Simulation simulation(start);
  simulation.run_until(7.3);
  Frame direct, stored;
  simulation.make_frame(direct);
  make_frame(simulation.state(), stored);
  CHECK(direct.x == stored.x);
  CHECK(direct.vy == stored.vy);
  CHECK(direct.time == stored.time);
  CHECK(direct.collisions_per_disk == stored.collisions_per_disk);
}

TEST_CASE("an inelastic collapse ends in an error, not in a hang") {
  // Undriven disks of low restitution collapse soon [McNamara & Young 1994: for eps below about 0.6 at this size].
  RandomSystem system;
  system.particles = 200;
  system.packing_fraction = 0.4;
  system.restitution = 0.1;
  State state = random_state(system);
  Simulation unprotected(state);
  CHECK_THROWS_AS(unprotected.run_until(200), RunError);
  state.collision.collapse = CollapsePolicy::tc;
  Simulation protected_by_tc(state);
  CHECK_NOTHROW(protected_by_tc.run_until(200));
}
