// A State for tests with a different value in every field.
#pragma once

#include <cstdint>
#include <limits>

#include "sandglass/core/state.h"

namespace sandglass {

inline State sample_state(std::size_t disks, std::uint64_t seed = 1) {
  State state;
  state.box_length = 40.1;
  state.mixture = {.radius = {1, 1.3}, .mass = {1, 1.7}};
  state.collision = {.restitution = 0.9, .collapse = CollapsePolicy::tc, .collapse_time = 1e-5};
  state.drive = {DriveKind::single, PartnerRule::within, 2.5, 3.25, 0.125};
  state.seed = seed;
  state.epoch_length = 1000;
  state.epoch = 3;
  state.now = 17.3;
  for (std::size_t id = 0; id < disks; ++id) {
    const double u = 1 / (static_cast<double>(id + seed) + 3);
    Disk disk;
    disk.x = 40 * u, disk.y = 30 * u;
    disk.vx = u, disk.vy = -3 * u;
    disk.time = 17.3 - u;
    if (id % 3 != 0) disk.last_contact = -5 * u, disk.next_kick = 17.3 + u;
    disk.kick_count = id * id, disk.image_x = static_cast<std::int32_t>(id), disk.image_y = -7;
    disk.species = id % 2 == 0 ? small : big;
    state.disks.push_back(disk);
  }
  state.tally.contacts = {10, 20, 30};
  state.tally.elastic_contacts = 4, state.tally.kicked = {50, 60}, state.tally.kicks = 70;
  state.tally.kicks_without_partner = 80, state.tally.transits = std::numeric_limits<std::uint64_t>::max();
  state.tally.virial.add(1e11), state.tally.dissipated.add(-0.1), state.tally.injected.add(1e-9);
  return state;
}

}  // namespace sandglass
