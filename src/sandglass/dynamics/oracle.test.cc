// The engine against the oracle, event by event and bit by bit, and the contract of canonical trajectories: the same
// bits whatever the engine's free choices, sampling, or where a run was cut and restarted.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <string>

#include "sandglass/dynamics/random_state.test.h"
#include "sandglass/dynamics/reference.h"
#include "sandglass/dynamics/simulation.h"

using namespace sandglass;

namespace {

RandomSystem any_system() {
  RandomSystem system;
  system.seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  system.particles = static_cast<std::size_t>(*rc::gen::element(2, 3, 4, 7, 16, 30, 60));
  system.packing_fraction = *rc::gen::element(0.02, 0.1, 0.3, 0.45, 0.6);
  system.size_ratio = *rc::gen::element(1.0, 1.43, 3.0);
  system.restitution = *rc::gen::element(1.0, 0.9, 0.5, 0.2);
  system.collapse = *rc::gen::element(CollapsePolicy::none, CollapsePolicy::tc);
  system.epoch_length = *rc::gen::element(0.7, 3.0, 1000.0);
  system.drive.kind = *rc::gen::element(DriveKind::none, DriveKind::pair, DriveKind::single);
  system.drive.partner = *rc::gen::element(PartnerRule::nearest, PartnerRule::within);
  system.drive.reach = *rc::gen::element(1.05, 1.5, 1.9);
  system.drive.frequency = *rc::gen::element(0.3, 2.0, 20.0);
  system.drive.amplitude = 0.5;
  // Strongly inelastic disks collapse: infinitely many collisions in a finite time. The TC model is for that.
  if (system.restitution < 0.9) system.collapse = CollapsePolicy::tc;
  return system;
}

Tuning any_tuning() {
  return {.skin = *rc::gen::element(0.0, 0.05, 0.3, 2.0),
          .cell_size = *rc::gen::element(0.0, 1.0, 7.0, 1000.0),
          .window_events = *rc::gen::element(0.0, 0.1, 50.0)};
}

double duration(const RandomSystem& system) { return system.packing_fraction < 0.2 ? 30 : 6; }

}  // namespace

TEST_CASE("the engine does the oracle's events, in the oracle's order, to the oracle's bits") {
  CHECK(rc::check([] {
    const RandomSystem system = any_system();
    const State start = random_state(system);
    std::vector<Event> events, expected;
    Simulation simulation(start, any_tuning());
    Reference reference(start);
    simulation.set_event_log(&events);
    reference.set_event_log(&expected);
    const double end = duration(system);
    simulation.run_until(end);
    reference.run_until(end);
    const std::size_t common = std::min(events.size(), expected.size());
    for (std::size_t i = 0; i < common; ++i)
      if (events[i] != expected[i])
        RC_FAIL("event " + std::to_string(i) + " of " + std::to_string(common) + " differs");
    RC_ASSERT(events.size() == expected.size());
    RC_ASSERT(state_hash(simulation.state()) == state_hash(reference.state()));
    RC_CLASSIFY(events.size() > 300, "long");
  }));
}

TEST_CASE("sampling, cutting and resuming change no bit") {
  CHECK(rc::check([] {
    RandomSystem system = any_system();
    system.particles = static_cast<std::size_t>(*rc::gen::element(20, 100, 400));
    const State start = random_state(system);
    const double end = duration(system);
    Simulation whole(start);
    whole.run_until(end);

    Simulation cut(start, any_tuning());
    Frame frame;
    const int cuts = *rc::gen::inRange(1, 12);
    for (int i = 1; i <= cuts; ++i) {
      cut.run_until(end * i / (cuts + 1));
      if (*rc::gen::arbitrary<bool>()) cut.make_frame(frame);
      if (*rc::gen::arbitrary<bool>()) cut = Simulation(cut.state(), any_tuning());
    }
    cut.run_until(end);
    RC_ASSERT(state_hash(whole.state()) == state_hash(cut.state()));
  }));
}

TEST_CASE("every instruction set gives the same bits") {
  RandomSystem system;
  system.particles = 1000;
  system.packing_fraction = 0.5;
  system.drive = {.kind = DriveKind::pair, .frequency = 5, .amplitude = 0.3};
  const State start = random_state(system);
  std::string hashes[3];
  const char* const names[3] = {"baseline", "avx2", "avx512"};
  for (int i = 0; i < 3; ++i) {
    ::setenv("SANDGLASS_ISA", names[i], 1);
    if (std::string(names[i]) != Simulation::instruction_set()) MESSAGE("this machine has no ", names[i]);
    Simulation simulation(start);
    simulation.run_until(20);
    CHECK(simulation.tally().collisions() > 10000);
    hashes[i] = state_hash(simulation.state());
  }
  ::unsetenv("SANDGLASS_ISA");
  CHECK(hashes[0] == hashes[1]);
  CHECK(hashes[0] == hashes[2]);
}
