// Disks without any order, for the tests of what is measured.
#pragma once

#include <cstdint>

#include "sandglass/core/frame.h"
#include "sandglass/core/random.h"
#include "sandglass/core/state.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Centres independent and uniform (an ideal gas: the disks overlap), unwrapped over several boxes; every third disk is
/// big. At rest: draw_velocities sets them in motion.
inline State scattered_disks(std::size_t n, double box_length, std::uint64_t seed) {
  State state;
  state.box_length = box_length;
  state.seed = seed;
  state.disks.resize(n);
  for (std::size_t id = 0; id < n; ++id) {
    const auto words = random_words(seed, Stream::positions, id, 0);
    state.disks[id].x = box_length * uniform(words[0]);
    state.disks[id].y = box_length * uniform(words[1]);
    state.disks[id].image_x = static_cast<int>(words[2] % 5) - 2;
    state.disks[id].species = id % 3 == 1 ? big : small;
  }
  return state;
}

/// The same as observers see them.
struct IdealGas {
  Frame frame;
  Population population;
};

inline IdealGas ideal_gas(std::size_t n, double box_length, std::uint64_t seed) {
  const State state = scattered_disks(n, box_length, seed);
  IdealGas system{{}, population_of(state)};
  make_frame(state, system.frame);
  return system;
}

}  // namespace sandglass
