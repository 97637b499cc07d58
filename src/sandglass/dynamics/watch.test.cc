// Faults put in by hand, and whether the self-check finds them.
#include "sandglass/dynamics/watch.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <memory>

#include "sandglass/dynamics/isa_engine.h"
#include "sandglass/dynamics/random_state.test.h"
#include "sandglass/dynamics/spatial_order.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// An engine in the middle of a run, whose tables can be damaged.
struct FaultInjection {
  State state;
  std::unique_ptr<Engine> engine;
  IsaEngine& damaged;

  explicit FaultInjection(const State& start)
      : state(start), engine(make_engine_baseline(state, {})), damaged(static_cast<IsaEngine&>(*engine)) {
    engine->load(spatial_order(state).data());
    engine->run(2);
  }
  Record& record(std::uint32_t i) { return damaged.tables_.records[i]; }
  ColdRecord& cold(std::uint32_t i) { return damaged.tables_.cold[i]; }
  std::uint32_t* list(std::uint32_t i) { return const_cast<std::uint32_t*>(damaged.whole_.neighbours().list(i)); }
  void forget_calendar() { damaged.whole_.set_calendar(Calendar(state.now, 1, 1, 0, false)); }
  std::uint32_t somebody_with_partner() {
    std::uint32_t i = 0;
    while (record(i).partner == no_disk) ++i;
    return i;
  }
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass

using namespace sandglass;

namespace {

State driven(DriveKind kind = DriveKind::pair) {
  RandomSystem system{.particles = 100, .packing_fraction = 0.45, .restitution = 0.8, .epoch_length = 1000};
  system.drive = {.kind = kind, .frequency = 2, .amplitude = 0.5};
  return random_state(system);
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
double with_bit_flipped(double value, int bit) {
  return std::bit_cast<double>(bits(value) ^ (std::uint64_t{1} << bit));
}

}  // namespace

TEST_CASE("nothing is found in an engine that is whole") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::single, DriveKind::none}) {
    FaultInjection run(driven(kind));
    for (int i = 0; i < 50; ++i) {
      run.engine->run(2 + 0.1 * i);
      const Inspection seen = run.engine->inspect();
      CHECK(seen.fault == Fault::none);
      State state = run.state;
      state.disks.resize(100);
      run.engine->store(state.disks.data());
      // Both add 100 energies, rounded to a quantum each.
      CHECK(seen.energy.value() == doctest::Approx(kinetic_energy(state)).epsilon(1e-13));
    }
  }
}

TEST_CASE("a disk at the end of its leash is not astray, however coarse the grid of a large box is") {
  // The grid counts in L / 2^32: 2e-5 to 5e-2 here. Looked at right before lists expire, disk after disk.
  for (const double packing_fraction : {1e-7, 1e-10, 1e-14}) {
    CAPTURE(packing_fraction);
    RandomSystem system{.particles = 200, .packing_fraction = packing_fraction, .epoch_length = 1e12};
    FaultInjection run(random_state(system));
    for (int expired = 0; expired < 300; ++expired) {
      double next = never;
      for (std::uint32_t i = 0; i < 200; ++i)
        if (run.record(i).next == Next::review) next = std::fmin(next, run.record(i).next_time);
      REQUIRE(next < never);
      run.engine->run(std::nextafter(next, 0.0));
      REQUIRE(run.engine->inspect().fault == Fault::none);
      run.engine->run(next);
    }
  }
}

TEST_CASE("every kind of fault in the tables is found and named") {
  struct Damage {
    Fault expected;
    std::function<void(FaultInjection&)> cause;
  };
  const Damage damages[] = {
      {Fault::not_a_number, [](auto& run) { run.record(7).vx = std::nan(""); }},
      {Fault::not_a_number, [](auto& run) { run.record(7).x = never; }},
      {Fault::outside_box, [](auto& run) { run.record(7).y = -0.001; }},
      {Fault::wrong_radius, [](auto& run) { run.record(7).radius = 1.2; }},
      {Fault::time_order, [](auto& run) { run.record(7).time = run.state.now + 1; }},
      {Fault::time_order, [](auto& run) { run.cold(7).last_contact = run.state.now + 1; }},
      {Fault::overdue_transit, [](auto& run) { run.record(7).time = -1e6; }},
      {Fault::missed_event, [](auto& run) { run.record(7).next_time = run.state.now - 0.1; }},
      {Fault::missed_event, [](auto& run) { run.cold(7).next_kick = run.state.now - 0.1; }},
      {Fault::one_sided, [](auto& run) { run.record(run.somebody_with_partner()).partner = 3'000'000; }},
      {Fault::one_sided,
       [](auto& run) { run.record(run.record(run.somebody_with_partner()).partner).partner = no_disk; }},
      {Fault::astray, [](auto& run) { run.cold(7).centre.x += 1u << 30; }},
      {Fault::wrong_list, [](auto& run) { run.list(7)[0] = run.list(7)[1]; }},
      {Fault::wrong_list, [](auto& run) { --run.record(7).neighbour_count; }},
      {Fault::overlap,
       [](auto& run) {  // carried, with its list centre, onto a neighbour
         Record &disk = run.record(7), &other = run.record(run.list(7)[0]);
         const double there = other.x + other.vx * (run.state.now - other.time);
         disk.x = there - disk.vx * (run.state.now - disk.time) + 0.5 * (disk.x < there ? -1 : 1);
       }},
  };
  for (const Damage& damage : damages) {
    FaultInjection run(driven());
    damage.cause(run);
    const Inspection seen = run.engine->inspect();
    CAPTURE(describe(seen));
    // Carrying a disk elsewhere may show as its having left its list's range before the overlap is seen.
    const bool found =
        seen.fault == damage.expected || (damage.expected == Fault::overlap && seen.fault == Fault::astray);
    CHECK(found);
  }
}

TEST_CASE("events lost from the calendar are found") {
  FaultInjection run(driven());
  run.forget_calendar();
  run.engine->run(3);
  CHECK(run.engine->inspect().fault == Fault::missed_event);
}

TEST_CASE("energy or momentum out of nowhere is found") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::none}) {
    Simulation run(driven(kind));
    Watch watch;
    watch.inspect(run);
    run.run_until(3);
    watch.inspect(run);
    run.run_until(4);
    for (const int bit : {62, 52, 45, 35}) {  // of 52 bits of mantissa; some 10^3 events allow for about 1e-9
      State changed = run.state();
      changed.disks[5].vx = with_bit_flipped(changed.disks[5].vx, bit);
      Watch later;
      later.inspect(run);
      if (std::isfinite(changed.disks[5].vx) && std::fabs(changed.disks[5].vx) < 1e100)
        CHECK_THROWS_AS(later.inspect(Simulation(changed)), Violation);
    }
    State turned = run.state();
    std::swap(turned.disks[5].vx, turned.disks[5].vy);  // the energy is the same
    CHECK_THROWS_AS(watch.inspect(Simulation(turned)), Violation);
  }
}

TEST_CASE("the first beats are watched as well") {
  Simulation run(driven());
  Watch watch;
  watch.before_beat(run);
  State changed = run.state();
  changed.disks[5].vx = with_bit_flipped(changed.disks[5].vx, 45);
  Simulation other(changed);
  other.run_until(0.1);
  CHECK_THROWS_AS(watch.inspect(other), Violation);
}

TEST_CASE("a witness agrees with a whole run, over epochs too") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::single, DriveKind::none}) {
    State start = driven(kind);
    start.epoch_length = 1;
    Simulation run(start);
    Watch watch(Vigilance::every_event);
    for (int beat = 1; beat <= 40; ++beat) {
      watch.before_beat(run);
      run.run_until(0.125 * beat);
      CHECK_NOTHROW(watch.after_beat(run));
    }
  }
}

TEST_CASE("a witness finds a single wrong bit") {
  State start = driven();
  for (const int bit : {0, 20, 51, 63}) {
    Simulation run(start);
    Watch watch(Vigilance::every_event);
    watch.before_beat(run);
    run.run_until(0.5);
    watch.after_beat(run);
    State changed = run.state();
    changed.disks[5].vy = with_bit_flipped(changed.disks[5].vy, bit);
    Simulation other(changed);
    watch.before_beat(other);
    other.run_until(1);
    CHECK_THROWS_AS(watch.after_beat(other), Violation);
  }
}
