// How the engine keeps a disk: one cache line that every prediction reads, and one that only its own events touch.
#pragma once

#include <cstdint>
#include <limits>

#include "sandglass/core/state.h"
#include "sandglass/dynamics/event.h"
#include "sandglass/dynamics/grid.h"

#ifndef SANDGLASS_ISA
#define SANDGLASS_ISA baseline
#endif

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// What comes next for a disk, in the order in which it is done at one time: a review (no event: its list expires, or
/// the partner of a foreseen contact has found another, or nothing was foreseen for long, and its next contact must be
/// looked for again), freezing (where several threads work, see freezing.cc), or the physical EventKind of the same
/// name. The calendar has one entry for a contact, under the slot of one of the two disks.
enum class Next : std::uint8_t { review, freeze, contact, contact_entered_by_partner, kick, transit };

/// Where several threads work: the strip of the first pass in whose calendar a disk may have entries, by its number
/// (the last of an odd number stands next to an even one); or none, where it has not left a lane since these were made
/// anew.
enum class Home : std::uint8_t { even, odd, last, none };

/// The hot half: the flight, and what comes next. A contact stands in the records of both its disks.
struct alignas(64) Record {
  double x, y, vx, vy;

  double time;
  double next_time;
  double radius;
  std::uint32_t partner;  ///< slot of the disk that `next` (a contact) names, else no_disk
  Next next;
  Species species : 4;
  bool concerned : 1;  ///< in this window the disk is frozen, or must look out for frozen ones
  bool roomy : 1;      ///< which leash it is on, see Tables
  Home home : 2;
  std::uint16_t neighbour_count;
};
static_assert(sizeof(Record) == 64);

/// A flight by itself: the record's first five numbers.
struct Flight {
  double x, y, vx, vy, time;
  explicit Flight(const Record& disk) : x(disk.x), y(disk.y), vx(disk.vx), vy(disk.vy), time(disk.time) {}
};

/// Writes what comes next for a disk.
[[gnu::always_inline]] inline void set_next(Record& disk, double next_time, Next next, std::uint32_t partner) {
  disk.next_time = next_time;
  disk.next = next;
  disk.partner = partner;
}

/// Writes a new flight, after which nothing comes yet.
[[gnu::always_inline]] inline void set_flight(Record& disk, const Flight& flight) {
  disk.x = flight.x, disk.y = flight.y, disk.vx = flight.vx, disk.vy = flight.vy, disk.time = flight.time;
  set_next(disk, std::numeric_limits<double>::infinity(), Next::review, no_disk);
}

/// A frozen disk has this as the time of its next event, which says how long after the start of the window it has been
/// frozen. No search finds a contact with it, since that would come later.
[[gnu::always_inline]] inline double frozen_after(double wait) { return -1 - wait; }
[[gnu::always_inline]] inline bool is_frozen(const Record& disk) { return disk.next_time < 0; }

/// The time of the next event of the record that fills up lists.
inline constexpr double nobodys = -std::numeric_limits<double>::infinity();

/// The cold half.
struct alignas(64) ColdRecord {
  static constexpr std::uint32_t listed_here = 8;
  std::uint32_t listed[listed_here];  ///< slots of its neighbours; the rest of a longer list is elsewhere (Neighbours)
  FixedPoint centre;                  ///< where the disk stood when its list was made
  double last_contact, next_kick;
  std::uint64_t kick_count;
};
static_assert(sizeof(ColdRecord) == 64);

/// In how many boxes to the right of the first, and above, the disk is. Changes so rarely that it stands apart.
struct Image {
  std::int32_t x, y;
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
