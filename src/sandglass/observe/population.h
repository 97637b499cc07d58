// Who the disks of a frame are, and a frame as the measurements use it: species by species, at rest as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// Which disks a result is about.
enum class Group : std::uint8_t { all, small, big };
inline constexpr std::array<Group, 3> groups{Group::all, Group::small, Group::big};
std::string group_name(Group group);

/// A stretch of disks, in the order of a Population.
struct Range {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

/// What does not change during a run. `order` lists the ids, small disks first, each species by id, so that a species
/// is one contiguous range of everything sorted by it.
struct Population {
  double box_length = 0;
  Mixture mixture;
  std::vector<std::uint32_t> order;
  std::size_t small_count = 0;

  [[nodiscard]] std::size_t size() const { return order.size(); }
  [[nodiscard]] Range range(Species species) const {
    return species == small ? Range{0, small_count} : Range{small_count, order.size()};
  }
  [[nodiscard]] Range range(Group group) const {
    return {group == Group::big ? small_count : 0, group == Group::small ? small_count : order.size()};
  }
};

Population population_of(const State& state);

/// Positions and velocities relative to the centre of mass, in the order of the population. Positions are unwrapped.
struct Snapshot {
  std::vector<double> x, y, vx, vy;
};

/// Sorts `frame` and subtracts the mass-weighted mean position and velocity (single kicks move the centre of mass). The
/// means are summed in the order of the population: same bits always.
void take_snapshot(const Frame& frame, const Population& population, Snapshot& snapshot);
/// The same of the velocities alone.
void take_velocities(const Frame& frame, const Population& population, Snapshot& snapshot);

/// Sums over disks are made block by block: within a block in a fixed order in doubles, across blocks exactly.
inline constexpr std::size_t block_size = 512;

/// Sum of `terms` in a fixed order that does eight lanes at a time. Inlined, so that it is as wide as who calls it.
[[gnu::always_inline]] inline double ordered_sum(std::span<const double> terms) {
  constexpr std::size_t lanes = 8;
  double lane[lanes] = {};
  const std::size_t whole = terms.size() / lanes * lanes;
  for (std::size_t i = 0; i < whole; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) lane[j] += terms[i + j];
  }
  for (std::size_t i = whole; i < terms.size(); ++i) lane[i - whole] += terms[i];
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

/// Kinetic temperatures T = <m v^2>/2 of a snapshot, by species and for all; 0 for a species without disks.
Temperatures temperatures(const Snapshot& snapshot, const Population& population);

}  // namespace sandglass
