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
          .window_events = *rc::gen::element(0.0, 0.1, 50.0, 1000.0),
          .most_in_cache = *rc::gen::element<std::size_t>(0, 20000),
          .batches = *rc::gen::element(Tuning::Batches::never, Tuning::Batches::always)};
}

Tuning in_batches() {
  Tuning tuning = any_tuning();
  tuning.most_in_cache = 20000;
  tuning.batches = Tuning::Batches::always;
  return tuning;
}

double duration(const RandomSystem& system) { return system.packing_fraction < 0.2 ? 30 : 6; }

/// Fails unless the engine does the oracle's events, in its order, to its bits. How many they are.
std::size_t follow_oracle(const State& start, const Tuning& tuning, double end) {
  std::vector<Event> events, expected;
  Simulation simulation(start, tuning);
  Reference reference(start);
  simulation.set_event_log(&events);
  reference.set_event_log(&expected);
  simulation.run_until(end);
  reference.run_until(end);
  const std::size_t common = std::min(events.size(), expected.size());
  for (std::size_t i = 0; i < common; ++i)
    if (events[i] != expected[i]) RC_FAIL("event " + std::to_string(i) + " of " + std::to_string(common) + " differs");
  RC_ASSERT(events.size() == expected.size());
  RC_ASSERT(state_hash(simulation.state()) == state_hash(reference.state()));
  return common;
}

void any_instruction_set() { ::setenv("SANDGLASS_ISA", *rc::gen::element("baseline", "avx2", "avx512"), 1); }

}  // namespace

TEST_CASE("the engine does the oracle's events, in the oracle's order, to the oracle's bits") {
  CHECK(rc::check([] {
    const RandomSystem system = any_system();
    const std::size_t events = follow_oracle(random_state(system), any_tuning(), duration(system));
    RC_CLASSIFY(events > 300, "long");
  }));
}

TEST_CASE("so it does where several events are worked out together") {  // undriven, with room for many far from another
  CHECK(rc::check([] {
    RandomSystem system = any_system();
    system.particles = static_cast<std::size_t>(*rc::gen::element(100, 250, 400));
    system.drive = {};
    any_instruction_set();
    // Some hundred events, each of which the oracle finds by a look at all disks.
    const double end = 60 / (static_cast<double>(system.particles) * system.packing_fraction);
    const std::size_t events = follow_oracle(random_state(system), in_batches(), end);
    RC_CLASSIFY(events > 100, "long");
  }));
  ::unsetenv("SANDGLASS_ISA");
}

TEST_CASE("so it does where many events come at one time") {
  // Equal disks on a square lattice, with coordinates and velocities that binary fractions hold exactly: those that
  // meet head-on do so at the same times all over the box, and exchange their velocities exactly.
  CHECK(rc::check([] {
    RandomSystem system;
    system.seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
    constexpr std::size_t side = 12;
    system.particles = side * side;
    system.size_ratio = 1;
    system.restitution = 1;
    system.epoch_length = 1000;
    State start = random_state(system);
    start.box_length = 4 * side;
    for (std::size_t id = 0; id < start.size(); ++id) {
      Disk& disk = start.disks[id];
      disk.x = 4 * static_cast<double>(id % side) + 1, disk.y = 4 * static_cast<double>(id / side) + 1;
      const auto words = random_words(system.seed, Stream::probe, id, 1);
      const double speed = 0.5 * (static_cast<double>(words[0] % 3) - 1);
      disk.vx = words[1] % 4 == 0 ? 0 : speed, disk.vy = words[1] % 4 == 0 ? speed : 0;
    }
    any_instruction_set();
    RC_ASSERT(follow_oracle(start, *rc::gen::arbitrary<bool>() ? in_batches() : any_tuning(), 6) > 20);
  }));
  ::unsetenv("SANDGLASS_ISA");
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
  for (const DriveKind kind : {DriveKind::pair, DriveKind::none}) {
    RandomSystem system;
    system.particles = 2000;  // several events together, if undriven
    system.packing_fraction = 0.5;
    system.drive = {.kind = kind, .frequency = 5, .amplitude = 0.3};
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
}
