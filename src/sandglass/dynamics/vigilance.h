// How closely a run is watched while it goes on.
#pragma once

#include <cstdint>

namespace sandglass {

enum class Vigilance : std::uint8_t {
  sampled,     ///< an inspection of all disks now and then, under 1 % of the time of the run
  every_event  ///< every event is done a second time by the rule, O(N) each
};

}  // namespace sandglass
