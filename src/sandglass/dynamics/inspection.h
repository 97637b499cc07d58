// What can be seen to be wrong with an engine between two events.
#pragma once

#include <cstdint>
#include <string>

#include "sandglass/core/exact_sum.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/event.h"

namespace sandglass {

enum class Fault : std::uint8_t {
  none,
  not_a_number,     ///< a coordinate or velocity is not finite
  outside_box,      ///< a record's centre is not in [0, L)
  wrong_radius,     ///< radius and species do not belong together
  time_order,       ///< a record, or its last contact, from the future
  overdue_transit,  ///< flown farther than a record may without being advanced
  missed_event,     ///< what was to come next, or the next kick, is past
  one_sided,        ///< a foreseen contact of which the partner does not know
  astray,           ///< farther from the centre of its list than the list allows
  wrong_list,       ///< its list is not that of the disks within range
  overlap           ///< two disks overlap by more than rounding, 1e-9 of their contact distance
};

/// The first fault found in the engine's tables, and sums over all records.
struct Inspection {
  Fault fault = Fault::none;
  std::uint32_t first = no_disk, second = no_disk;  ///< ids of the disks concerned
  ExactSum energy;                                  ///< kinetic, of all disks; the sums are empty after a fault
  ExactSum momentum_x, momentum_y;
};

/// "disks 3 and 7 overlap", for people.
std::string describe(const Inspection& inspection);

}  // namespace sandglass
