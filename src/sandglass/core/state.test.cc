#include "sandglass/core/state.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "sandglass/core/frame.h"

using namespace sandglass;

namespace {

State example(std::size_t n) {
  State state;
  state.seed = 5;
  state.disks.resize(n);
  for (std::size_t id = n / 2; id < n; ++id) state.disks[id].species = big;
  state.box_length = box_length_for(state.mixture, n - n / 2, n / 2, 0.4);
  return state;
}

}  // namespace

TEST_CASE("the box holds the wanted area fraction") {
  const State state = example(1000);
  const double area = std::numbers::pi * 500 * (1 + 1.43 * 1.43);
  CHECK(area / (state.box_length * state.box_length) == doctest::Approx(0.4).epsilon(1e-14));
  CHECK(packing_fraction(state) == doctest::Approx(0.4).epsilon(1e-14));
  CHECK(minimum_box_length(state.mixture) == 8 * 1.43);
}

TEST_CASE("drawn velocities have no momentum, exactly the wanted temperature, equal by species") {
  State state = example(20000);
  draw_velocities(state, 2.5);
  CHECK(std::fabs(total_momentum(state)[0]) < 1e-9);
  CHECK(std::fabs(total_momentum(state)[1]) < 1e-9);
  const Temperatures t = temperatures(state);
  CHECK(t.all == doctest::Approx(2.5).epsilon(1e-12));
  // T_small averages 10^4 exponential variates: relative sigma 0.01, less by half for the common scale. 5 sigma.
  CHECK(t.small == doctest::Approx(2.5).epsilon(0.04));
  CHECK(t.big == doctest::Approx(2.5).epsilon(0.04));
}

TEST_CASE("kick clocks ring at f/2 per disk for pairs, f for single kicks, never without a drive") {
  State state = example(20000);
  auto mean_wait = [&](DriveKind kind) {
    state.drive.kind = kind;
    state.drive.frequency = 3;
    start_kick_clocks(state);
    double sum = 0;
    for (const Disk& disk : state.disks) sum += disk.next_kick;
    return sum / static_cast<double>(state.size());
  };
  // Mean of 2*10^4 exponentials: relative sigma 0.007; 5 sigma.
  CHECK(mean_wait(DriveKind::pair) == doctest::Approx(2.0 / 3).epsilon(0.036));
  CHECK(mean_wait(DriveKind::single) == doctest::Approx(1.0 / 3).epsilon(0.036));
  CHECK(std::isinf(mean_wait(DriveKind::none)));
}

TEST_CASE("the hash sees every field of a record") {
  std::set<std::string> seen;
  State state = example(10);
  seen.insert(state_hash(state));
  std::size_t expected = 1;
  auto changed = [&](auto&& change) {
    State other = state;
    change(other);
    seen.insert(state_hash(other));
    CHECK(seen.size() == ++expected);
  };
  changed([](State& s) { s.disks[3].x = 1; });
  changed([](State& s) { s.disks[4].x = 1; });
  changed([](State& s) { s.disks[3].vy = -0.0; });
  changed([](State& s) { s.disks[3].time = 1; });
  changed([](State& s) { s.disks[3].last_contact = 0; });
  changed([](State& s) { s.disks[3].next_kick = 0; });
  changed([](State& s) { s.disks[3].kick_count = 1; });
  changed([](State& s) { s.disks[3].image_x = 1; });
  changed([](State& s) { s.disks[3].image_y = 1; });
  changed([](State& s) { s.disks[3].species = big; });
  changed([](State& s) { s.epoch = 1; });
  changed([](State& s) { s.now = 1; });
  changed([](State& s) { s.tally.kicks = 1; });
  changed([](State& s) { s.tally.virial.add(1); });
  CHECK(seen.begin()->size() == 16);
}

TEST_CASE("a frame shows the disks advanced and unwrapped") {
  State state = example(2);
  state.epoch_length = 10;
  state.epoch = 2;
  state.now = 3;
  state.disks[1] = {.x = 1, .y = 2, .vx = 0.5, .vy = -1, .time = 1, .image_x = -1, .image_y = 2, .species = big};
  Frame frame;
  make_frame(state, frame);
  CHECK(frame.time == 23);
  CHECK(frame.x[1] == doctest::Approx(2 - state.box_length));
  CHECK(frame.y[1] == doctest::Approx(2 * state.box_length));
  CHECK(frame.vx[1] == 0.5);
}
