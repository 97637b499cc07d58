// Hard disks stay hard: after very many collisions at high density no two overlap beyond rounding, and time goes on.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sandglass/prepare/grid.h"
#include "sandglass/prepare/periodic.h"
#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

namespace {

/// Deepest overlap of two disks, R_i + R_j - distance, at the time of the frame; negative if all are apart.
double deepest_overlap_in(const State& state, const Frame& frame) {
  const double length = state.box_length;
  Grid grid(length, 2.2 * state.mixture.radius[big], frame.size());
  double deepest = -state.mixture.radius[big];
  for (std::uint32_t id = 0; id < frame.size(); ++id) {
    const double x = wrapped(frame.x[id], length), y = wrapped(frame.y[id], length);
    grid.visit_near(x, y, [&](std::uint32_t other) {
      const double contact =
          state.mixture.radius[state.disks[id].species] + state.mixture.radius[state.disks[other].species];
      const double dx = nearest_image(wrapped(frame.x[other], length) - x, length);
      const double dy = nearest_image(wrapped(frame.y[other], length) - y, length);
      deepest = std::max(deepest, contact - std::sqrt(dx * dx + dy * dy));
      return true;
    });
    grid.add(id, x, y);
  }
  return deepest;
}

/// The time of a contact soon to come, found by a copy sent ahead. (The log counts from the start of the epoch.)
double next_contact(const Simulation& simulation, double ahead) {
  Simulation scout(simulation.state());
  const auto epoch_start = [&] { return scout.time() - scout.state().now; };
  for (;;) {
    std::vector<Event> log;
    scout.set_event_log(&log);
    const double origin = epoch_start();
    scout.run_until(scout.time() + ahead);
    scout.set_event_log(nullptr);
    const auto contact =
        std::find_if(log.rbegin(), log.rend(), [](const Event& e) { return e.kind == EventKind::contact; });
    if (contact != log.rend() && epoch_start() == origin) return origin + contact->time;
  }
}

/// eta = 0.81, eps = 0.5, driven and protected from collapse as a run is, for `collisions` collisions.
void check_hardness(std::uint64_t collisions) {
  State state = start(1.43, 1000, 0.81, 51);
  drive(state, DriveKind::pair, 0.5);
  const double free_time = 1 / state.drive.frequency;
  state.collision.collapse = CollapsePolicy::tc;
  state.collision.collapse_time = 2e-6 * free_time;
  const State initial = state;
  Simulation simulation(std::move(state));
  Frame frame;
  double deepest = -1, shallowest = 1;
  for (std::uint64_t done = 0; done < collisions; done = simulation.tally().collisions()) {
    simulation.run_until(simulation.time() + 30 * free_time);
    simulation.run_until(next_contact(simulation, 0.01 * free_time));  // so that two disks touch just now
    simulation.make_frame(frame);
    const double overlap = deepest_overlap_in(initial, frame);
    deepest = std::max(deepest, overlap);
    shallowest = std::min(shallowest, overlap);
  }
  // A contact time is rounded to 2^-53 of at most 1000 mean free times, about 20 time units: 4e-15 at the speeds here
  // (up to 5), and centres in a box of 80 to 1e-14, a few times each. Ten such errors in a row are 2e-13.
  CHECK(deepest < 2e-13);
  // The time of the look counts from the start of the run, up to 4000 units in the long test: rounded to 5e-13, in
  // which disks that approach at less than 10 come as near as 5e-12.
  CHECK(shallowest > -5e-12);
  // No stall: the collision rate stays of the order of the formula's, at this density up to a few times larger.
  const double total = static_cast<double>(simulation.tally().collisions());
  const double rate = 2 * total / 1000 / simulation.time();
  CHECK(rate * free_time > 0.5);
  CHECK(rate * free_time < 10);
  CHECK(static_cast<double>(simulation.tally().elastic_contacts) < 1e-3 * total);
}

}  // namespace

TEST_CASE("no overlap and no stall in 10^7 inelastic collisions at eta = 0.81") { check_hardness(10'000'000); }

TEST_SUITE_BEGIN("long");
TEST_CASE("no overlap and no stall in 10^8 inelastic collisions at eta = 0.81") { check_hardness(100'000'000); }
TEST_SUITE_END();
