// Some events that come next, which are worked out together (batch.cc).
#pragma once

#include <cstdint>

#include "sandglass/dynamics/record.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Contacts and reviews. Lane m is that of the first disk of event m, lane m + size that of the second; a review has
/// but one. What is not set for an event or a lane is worked out as well, and means nothing.
struct Batch {
  static constexpr unsigned size = 8, lanes = 2 * size;
  static constexpr unsigned listed = ColdRecord::listed_here;  // of each list, those that are searched first

  // The events, in order
  unsigned count;
  bool late;                              // the first is not one of the calendar's sorted entries
  unsigned entries[size];                 // of these, how many there are up to the event's own
  bool contact[size];                     // else a review
  alignas(64) double contact_if_1[size];  // the same
  bool elastic[size];                     // by the TC model
  alignas(64) double time[size];
  alignas(64) double restitution[size], reduced[size], reduced_low[size], inverse_a[size], inverse_b[size];
  alignas(64) double virial[size], dissipated[size];  // for the tally

  // The disks, and their flights after the event
  alignas(64) std::uint32_t slot[lanes];
  alignas(64) std::uint64_t centre[lanes];  // of the list: x, and y in the upper half
  alignas(64) double leash_squared[lanes];
  alignas(64) double x[lanes], y[lanes], vx[lanes], vy[lanes], flown_to[lanes];
  alignas(64) double image_x[lanes], image_y[lanes];  // by how many the disk has come into another
  unsigned wrapped;                                   // lanes where that is not none
  unsigned special;  // lanes of disks that may be kicked, or must look out for frozen ones

  // The searches: each for a lane, with the first of its list
  unsigned searches;
  unsigned lane[lanes + 1];
  alignas(64) double ru[lanes][listed], c[lanes][listed],
      discriminant[lanes][listed], from[lanes][listed], limit[lanes][listed], when[lanes][listed];
  bool tied[lanes];

  // With the rest of the lists, one after the other
  static constexpr unsigned room = lanes * listed + 8;
  alignas(64) std::uint32_t far_slot[room];
  alignas(64) double far_x[room], far_y[room], far_vx[room], far_vy[room], far_time[room], far_radius[room];
  unsigned far_lane[room];

  // What has been found for each lane: the earliest contact, and what comes first apart from contacts
  alignas(64) double soonest[lanes], otherwise[lanes];
  std::uint32_t partner[lanes];
  unsigned doubtful;  // lanes where it is for the rule to tell who the partner is
  unsigned transits;  // lanes where that comes first apart from contacts; else it is a review

  // What is to be entered into the calendar
  double entry_time[2 * lanes + 1];
  std::uint32_t entry_slot[2 * lanes + 1];

  Record nobody;  // is written to where there is no other disk
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
