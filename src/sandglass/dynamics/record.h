// How the engine keeps a disk: one cache line that every prediction reads, one that only its own events touch.
#pragma once

#include <cstdint>

#include "sandglass/core/state.h"
#include "sandglass/dynamics/event.h"

#ifndef SANDGLASS_ISA
#define SANDGLASS_ISA baseline
#endif

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// What comes next for a disk. The first three are the physical EventKinds of the same names, in the same order.
enum class Next : std::uint8_t { contact, kick, transit, list_expiry };

/// The hot half: the flight, and what comes next. A contact stands in the records of both its disks.
struct alignas(64) Record {
  double x, y, vx, vy, time;
  double next_time;
  double radius;
  std::uint32_t partner;  ///< slot of the disk that `next` (a contact) names, else no_disk
  Next next;
  Species species;
  std::uint16_t neighbour_count;
};
static_assert(sizeof(Record) == 64);

/// The cold half.
struct alignas(64) ColdRecord {
  double centre_x, centre_y;  ///< where the disk stood when its neighbour list was made
  double last_contact, next_kick;
  std::uint64_t kick_count;
  std::int32_t image_x, image_y;
  std::uint32_t id;
  std::uint32_t cell;       ///< of the list centre
  std::uint32_t cell_next;  ///< next slot in the same cell, or no_disk
};
static_assert(sizeof(ColdRecord) == 64);

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
