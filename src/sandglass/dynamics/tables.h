// What all threads of an engine share: the disks by slot, and their lists.
#pragma once

#include "sandglass/core/state.h"
#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/neighbours.h"
#include "sandglass/dynamics/record.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

inline constexpr double never = std::numeric_limits<double>::infinity();

/// The stretch of time that several threads do together, each in its own part of the plane (see windows.cc).
struct Window {
  double start = 0, end = never;
  double top_speed[species_count] = {never, never};  ///< no frozen disk may be faster, or the window is undone
  double way = 0;                                    ///< the farthest that one may come
};

struct Tables {
  explicit Tables(const State& whole) : state(whole), box(whole.box_length, whole.mixture) {
    for (const int a : {small, big})
      for (const int b : {small, big}) masses[a][b] = PairMasses(state.mixture.mass[a], state.mixture.mass[b]);
  }

  const State& state;  ///< for the collision law, the drive, the seed
  Box box;
  PairMasses masses[species_count][species_count];  ///< by species of the first and the second disk
  std::size_t size = 0;
  Array<Record> records;  ///< one more than there are disks: it fills up lists
  Array<ColdRecord> cold;
  Array<std::uint32_t> ids;
  Array<Image> images;
  NeighbourTable neighbours;
  /// How far a disk may move from the centre of its list: half the skin where it is roomy (true); less by half the way
  /// of a frozen disk where one may come.
  double leash[2] = {0, 0};

  /// Where several threads work, by the row of the list centre: disks that stand in a lane or so near one that they may
  /// be frozen, and those beside, as far as these may reach, are on the short leash; all others on the long one.
  /// Without threads there are no rows, and all are.
  enum class Zone : std::uint8_t { near_lane, beside, roomy };
  Array<Zone> zones;
  [[nodiscard]] Zone zone(std::uint32_t row) const { return zones.size() == 0 ? Zone::roomy : zones[row]; }
  Array<Home> homes;  ///< by the same row: the strip of the first pass that it belongs to
  Window window;

  bool out_of_cache = false;  ///< the records do not fit into the cache
  bool in_batches = false;    ///< events are worked out several at a time (batch.cc)
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
