// Several threads against one: the same events, the same bits, whatever strips and windows there are.
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <string>

#include "sandglass/dynamics/random_state.test.h"
#include "sandglass/dynamics/simulation.h"

using namespace sandglass;

namespace {

RandomSystem any_system() {
  RandomSystem system;
  system.seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  system.particles = static_cast<std::size_t>(*rc::gen::element(150, 400, 1000, 2000));
  system.packing_fraction = *rc::gen::element(0.02, 0.1, 0.3, 0.45, 0.6);
  system.size_ratio = *rc::gen::element(1.0, 1.43, 2.0);
  system.restitution = *rc::gen::element(1.0, 0.9, 0.5);
  system.collapse = system.restitution < 0.9 ? CollapsePolicy::tc : CollapsePolicy::none;
  system.epoch_length = *rc::gen::element(0.7, 3.0, 1000.0);
  system.drive.kind = *rc::gen::element(DriveKind::none, DriveKind::pair, DriveKind::pair, DriveKind::single);
  system.drive.frequency = *rc::gen::element(0.3, 2.0, 10.0);
  system.drive.amplitude = 0.5;
  return system;
}

/// Strips and windows so small that most disks are frozen, some again and again; or a speed that disks often exceed, or
/// a depth beyond which they are often frozen.
Tuning any_tuning() {
  return {.skin = *rc::gen::element(0.05, 0.3, 1.0, 2.0),
          .cell_size = *rc::gen::element(0.0, 1.0, 1.5, 4.0),
          .most_in_cache = *rc::gen::element<std::size_t>(0, 20000),
          .batches = *rc::gen::element(Tuning::Batches::never, Tuning::Batches::always),
          .threads = static_cast<unsigned>(*rc::gen::element(2, 3, 4)),
          .strip_rows = 1,
          .window_part = *rc::gen::element(0.0, 0.1, 0.5, 0.9),
          .freezing_depth = *rc::gen::element(0.0, 0.0, 1.0, 5.0),
          .top_speed = *rc::gen::element(0.0, 3.0, 5.0, 10.0)};
}

}  // namespace

TEST_CASE("several threads do the events of one, to the same bits") {
  std::uint64_t windows = 0, undone = 0, left_over = 0;
  CHECK(rc::check([&] {
    const RandomSystem system = any_system();
    const State start = random_state(system);
    std::vector<Event> events, expected;
    Simulation one(start), several(start, any_tuning());
    one.set_event_log(&expected);
    several.set_event_log(&events);
    const double end = (system.packing_fraction < 0.2 ? 600.0 : 200.0) / static_cast<double>(system.particles) + 0.1;
    Frame frame, expected_frame;
    for (const double part : {0.31, 0.77, 1.0}) {
      one.run_until(part * end);
      several.run_until(part * end);
      one.make_frame(expected_frame);
      several.make_frame(frame);
      RC_ASSERT(frame.x == expected_frame.x);
      const Simulation::Bookkeeping work = several.bookkeeping();
      windows += work.windows, undone += work.windows_undone, left_over += work.left_over;
      several = Simulation(several.state(), any_tuning());  // as from a checkpoint
      several.set_event_log(&events);
    }
    // Each strip in order of time; a contact late by rounding may stand elsewhere in the log of one thread.
    std::sort(events.begin(), events.end());
    std::sort(expected.begin(), expected.end());
    RC_ASSERT(events == expected);
    RC_ASSERT(state_hash(several.state()) == state_hash(one.state()));
  }));
  MESSAGE(windows, " windows, ", undone, " undone, ", left_over, " disks left over");
  CHECK(windows > 1000);
  CHECK(undone > 10);
  CHECK(left_over > 1000);
}

TEST_CASE("disks that fly from strip to strip leave no event behind") {
  // So few that they go far between collisions: through a lane of some nine radii while calendars are kept, with
  // kicks that were foreseen in the strip they come from. (A strip that does an event of another's disk fails an
  // assertion.)
  for (const unsigned threads : {2u, 3u, 4u}) {
    for (const DriveKind kind : {DriveKind::none, DriveKind::single}) {
      RandomSystem system;
      system.seed = threads;
      system.particles = 600;
      system.packing_fraction = 0.02;
      system.drive = {.kind = kind, .frequency = 0.3, .amplitude = 0.5};
      system.epoch_length = 1000;
      const State start = random_state(system);
      Simulation one(start), several(start, {.skin = 6.0, .threads = threads, .strip_rows = 1, .window_part = 0.9});
      for (const double end : {20.0, 40.0, 60.0}) {
        one.run_until(end);
        several.run_until(end);
        CHECK(state_hash(several.state()) == state_hash(one.state()));
      }
      CHECK(several.threads() == threads);
      CHECK(several.bookkeeping().windows > 50);
    }
  }
}

TEST_CASE("every number of threads gives the same hash, with strips as they are in use") {
  for (const DriveKind kind : {DriveKind::none, DriveKind::pair, DriveKind::single}) {
    RandomSystem system;
    system.particles = 20000;
    system.packing_fraction = 0.5;
    system.drive = {.kind = kind, .frequency = 2, .amplitude = 0.3};
    const State start = random_state(system);
    std::string expected;
    for (const unsigned threads : {1u, 2u, 3u, 4u, 8u, 16u}) {
      // Higher than three wide lanes, which is the least that is taken to be worth it.
      Simulation simulation(start, {.threads = threads, .strip_rows = 18});
      simulation.run_until(0.7);
      if (threads == 1) expected = state_hash(simulation.state());
      CHECK(state_hash(simulation.state()) == expected);
      CHECK((simulation.threads() > 1) == (threads > 1));
      CHECK(simulation.bookkeeping().left_over * 100 <= simulation.bookkeeping().frozen);
    }
  }
}
