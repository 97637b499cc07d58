// The physical events and their order.
#pragma once

#include <compare>
#include <cstdint>

namespace sandglass {

/// In the order in which events at one time are done. (Expiry of a neighbour list is bookkeeping, not an event.)
enum class EventKind : std::uint8_t { contact, kick, transit, epoch, sample, stop };

inline constexpr std::uint32_t no_disk = 0xffffffffu;

/// A physical event: contact of two disks (first < second by id), kick of `first` with partner `second` (or no_disk),
/// transit of `first`. Events are ordered by time, then kind, then ids.
struct Event {
  double time = 0;  ///< since the start of the epoch
  EventKind kind = EventKind::stop;
  std::uint32_t first = no_disk, second = no_disk;

  friend auto operator<=>(const Event&, const Event&) = default;
};

}  // namespace sandglass
