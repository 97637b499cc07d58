// contact_time (contact.h) of several pairs of disks, lane by lane: the same operations in the same order, the same
// bits.
#pragma once

#include "sandglass/dynamics/simd.h"

#ifdef SANDGLASS_SIMD

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Flights and radii of disks, one to a lane.
struct FlightColumns {
  Vector x, y, vx, vy, time, radius;
};

/// A contact as far as the root: with r, u the separation and relative velocity at the reference time `from`, ru = r.u,
/// c = r^2 - contact^2, discriminant = ru^2 - u^2 c.
struct Approach {
  Vector from, ru, c, discriminant;

  Approach(Vector from_, Vector ru_, Vector c_, Vector discriminant_)
      : from(from_), ru(ru_), c(c_), discriminant(discriminant_) {}

  /// `other`: columns of records (x, y, vx, vy, time, next_time, radius).
  template <class Box>
  [[gnu::always_inline]] inline Approach(const FlightColumns& disk, const Vector (&other)[8], const Box& box) {
    from = max(disk.time, other[4]);
    const Vector flight = from - disk.time, other_flight = from - other[4];
    const Vector rx = nearest(fma(other[2], other_flight, other[0]) - fma(disk.vx, flight, disk.x), box);
    const Vector ry = nearest(fma(other[3], other_flight, other[1]) - fma(disk.vy, flight, disk.y), box);
    const Vector ux = other[2] - disk.vx, uy = other[3] - disk.vy;
    const Vector contact = disk.radius + other[6];
    ru = fma(rx, ux, ry * uy);
    c = fma(rx, rx, fms(ry, ry, contact * contact));
    discriminant = fms(ru, ru, fma(ux, ux, uy * uy) * c);
  }

  /// Whether they meet. (Where they touch already, c <= 0, the discriminant is not negative.)
  [[nodiscard]] Mask meets() const { return (ru < Vector::all(0)) & (Vector::all(0) <= discriminant); }

  /// When they do.
  [[nodiscard]] Vector contact_time() const {
    const Vector zero = Vector::all(0);
    return from + choose(c <= zero, zero, c / (sqrt(discriminant) - ru));
  }
};

/// When disks meet others, but never where that would come after what the other has next, and where it does not count.
template <class Box>
[[gnu::always_inline]] inline Vector contact_times(const FlightColumns& disk, const Vector (&other)[8], Mask counts,
                                                   const Box& box) {
  const Approach approach(disk, other, box);
  const Vector when = approach.contact_time();
  return choose(counts & approach.meets() & (when <= other[5]), when, Vector::all(never));
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass

#endif
