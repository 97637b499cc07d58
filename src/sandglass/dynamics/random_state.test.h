// Small random systems for the tests of the dynamics.
#pragma once

#include <cmath>
#include <cstdint>

#include "sandglass/core/random.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/contact.h"

namespace sandglass {

struct RandomSystem {
  std::uint64_t seed = 1;
  std::size_t particles = 20;
  double packing_fraction = 0.3;
  double size_ratio = 1.43;
  double restitution = 0.9;
  CollapsePolicy collapse = CollapsePolicy::none;
  Drive drive{};
  double epoch_length = 5;
};

/// Disks on a jittered square lattice in random order (possible up to a packing fraction of about 0.5), T = 1.
inline State random_state(const RandomSystem& system) {
  State state;
  state.seed = system.seed;
  state.mixture.radius[big] = system.size_ratio;
  state.mixture.mass[big] = system.size_ratio * system.size_ratio;
  state.collision = {system.restitution, system.collapse, 1e-3};
  state.drive = system.drive;
  state.epoch_length = system.epoch_length;
  const std::size_t n = system.particles;
  state.disks.resize(n);
  for (std::size_t id = n / 2; id < n; ++id) state.disks[id].species = big;
  const double length = box_length_for(state.mixture, n - n / 2, n / 2, system.packing_fraction);
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const double smallest_cell = 2.0001 * system.size_ratio;
  const double smallest_box = minimum_box_length(state.mixture);
  state.box_length = std::fmax(std::fmax(length, smallest_box), smallest_cell * static_cast<double>(side));
  const double cell = state.box_length / static_cast<double>(side);
  const double room = cell - smallest_cell;
  std::vector<std::size_t> sites(side * side);
  for (std::size_t i = 0; i < sites.size(); ++i) sites[i] = i;
  for (std::size_t id = 0; id < n; ++id) {
    const auto words = random_words(system.seed, Stream::probe, id, 0);
    std::swap(sites[id], sites[id + words[0] % (sites.size() - id)]);
    Disk& disk = state.disks[id];
    disk.x = (static_cast<double>(sites[id] % side) + 0.5) * cell + (uniform(words[1]) - 0.5) * room;
    disk.y = (static_cast<double>(sites[id] / side) + 0.5) * cell + (uniform(words[2]) - 0.5) * room;
  }
  draw_velocities(state, 1);
  start_kick_clocks(state);
  return state;
}

/// The deepest overlap of any two disks at the state's own time, over all pairs.
inline double deepest_overlap(const State& state) {
  const Box box(state.box_length, state.mixture);
  double deepest = 0;
  for (std::size_t i = 0; i < state.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Disk &a = state.disks[i], &b = state.disks[j];
      const double contact = state.mixture.radius[a.species] + state.mixture.radius[b.species];
      deepest = std::fmax(deepest, -surface_gap(a, b, contact, state.now, box));
    }
  return deepest;
}

}  // namespace sandglass
