// Engine against oracle where the product lives: jammed packings, expanded a little, with every kind of drive. Event by
// event and bit by bit; no tolerance. (The property tests beside the engine cover dilute and random systems.)
#include <doctest/doctest.h>

#include <string>

#include "sandglass/dynamics/reference.h"
#include "setup.h"

using namespace sandglass;

namespace {

void compare(const State& start, double end, const std::string& name) {
  INFO(name);
  std::vector<Event> events, expected;
  Simulation simulation(start);
  Reference reference(start);
  simulation.set_event_log(&events);
  reference.set_event_log(&expected);
  simulation.run_until(end / 3);
  State cut = simulation.state();
  simulation = Simulation(std::move(cut), {.skin = 0.4, .cell_size = 5, .window_events = 20});
  simulation.set_event_log(&events);
  simulation.run_until(end);
  reference.run_until(end);
  CHECK(expected.size() > 20 * start.size());
  CHECK(events == expected);
  CHECK(state_hash(simulation.state()) == state_hash(reference.state()));
}

}  // namespace

TEST_CASE("dense systems: the engine does the oracle's events") {
  for (const double eta : {0.7, 0.78, 0.82}) {
    for (const std::size_t particles : {30u, 60u}) {
      for (const double restitution : {1.0, 0.9, 0.5}) {
        for (const DriveKind kind : {DriveKind::none, DriveKind::pair, DriveKind::single}) {
          for (const PartnerRule partner : {PartnerRule::nearest, PartnerRule::within}) {
            const bool driven = kind != DriveKind::none;
            if (driven == (restitution == 1) || (kind != DriveKind::pair && partner == PartnerRule::within)) continue;
            State state = physics::start(1.43, particles, eta, 11 * particles);
            const double free_time = state.epoch_length / 1000;
            if (driven) physics::drive(state, kind, restitution);
            state.drive.partner = partner;
            state.drive.reach = 1.4;
            state.collision.collapse = CollapsePolicy::tc;
            state.collision.collapse_time = 1e-5 * free_time;
            state.epoch_length = 17 * free_time;
            start_kick_clocks(state);
            compare(state, 60 * free_time,
                    "eta " + std::to_string(eta) + ", N " + std::to_string(particles) + ", restitution " +
                        std::to_string(restitution) + ", drive " + std::to_string(static_cast<int>(kind)));
          }
        }
      }
    }
  }
}
