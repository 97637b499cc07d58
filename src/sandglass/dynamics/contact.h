// When two disks touch, and what the contact does to them: the canonical formulas, shared by the engine and the oracle.
//
// Every function is a fixed sequence of fma, + - * / sqrt and nearbyint on the two records alone, symmetric under
// exchange of the disks to the last bit. The record types (Disk, the engine's Record) have x, y, vx, vy and time.
#pragma once

#include <cmath>
#include <limits>

#include "sandglass/core/state.h"

// The engine is compiled once per instruction set; what is inlined into it must not be shared between the copies.
#ifndef SANDGLASS_ISA
#define SANDGLASS_ISA baseline
#endif

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// The periodic square. `transit` is how far a disk may fly (in either coordinate) before its record must be
/// advanced: with both disks within (L/2 - 2 R_max)/2 of their records, the image nearest at the reference time is
/// the only one that can be touched before the next change of either record. A quarter of the box, less a radius.
struct Box {
  double length, inverse, transit;

  Box(double box_length, const Mixture& mixture)
      : length(box_length),
        inverse(1 / box_length),
        transit(box_length / 4 - (mixture.radius[0] > mixture.radius[1] ? mixture.radius[0] : mixture.radius[1])) {}

  [[gnu::always_inline]] double nearest(double difference) const {
    return std::fma(-length, std::nearbyint(difference * inverse), difference);
  }
};

/// Where a disk, flying freely, is at time t; perhaps outside the box.
struct Position {
  double x, y;
};
template <class A>
[[gnu::always_inline]] inline Position position_at(const A& disk, double t) {
  const double flight = t - disk.time;
  return {std::fma(disk.vx, flight, disk.x), std::fma(disk.vy, flight, disk.y)};
}

/// Separation of two disks (b minus a, nearest image) at time t.
struct Separation {
  double x, y;
};
template <class A, class B>
[[gnu::always_inline]] inline Separation separation_at(const A& a, const B& b, double t, const Box& box) {
  const Position at_a = position_at(a, t), at_b = position_at(b, t);
  return {box.nearest(at_b.x - at_a.x), box.nearest(at_b.y - at_a.y)};
}

/// Time at which disks a and b, flying freely from their records, come to the distance `contact` = R_a + R_b of their
/// centres; infinity if they do not. With r, v the separation and relative velocity at the reference time
/// t = max(t_a, t_b): the smaller root of |r + v (s - t)| = contact, in the form without cancellation,
/// s = t + c / (-b + sqrt(b^2 - v^2 c)), b = r.v, c = r^2 - contact^2. Disks that overlap by rounding (c <= 0) and
/// approach (b < 0) touch at t; disks that do not approach never touch.
template <class A, class B>
[[gnu::always_inline]] inline double contact_time(const A& a, const B& b, double contact, const Box& box) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const double t = a.time > b.time ? a.time : b.time;
  const auto [rx, ry] = separation_at(a, b, t, box);
  const double vx = b.vx - a.vx, vy = b.vy - a.vy;
  const double rv = std::fma(rx, vx, ry * vy);
  if (!(rv < 0)) return never;
  const double c = std::fma(rx, rx, std::fma(ry, ry, -(contact * contact)));
  if (c <= 0) return t;
  const double vv = std::fma(vx, vx, vy * vy);
  const double discriminant = std::fma(rv, rv, -(vv * c));
  if (!(discriminant >= 0)) return never;
  return t + c / (std::sqrt(discriminant) - rv);
}

/// Gap between the surfaces of two disks at time t (negative: overlap).
template <class A, class B>
[[gnu::always_inline]] inline double surface_gap(const A& a, const B& b, double contact, double t, const Box& box) {
  const auto [rx, ry] = separation_at(a, b, t, box);
  return std::sqrt(std::fma(rx, rx, ry * ry)) - contact;
}

/// Moves a record to time t along its flight and wraps it into the box.
template <class Record, class Image>
[[gnu::always_inline]] inline void advance(Record& disk, Image& image_x, Image& image_y, double t, const Box& box) {
  const double flight = t - disk.time;
  disk.x = std::fma(disk.vx, flight, disk.x);
  disk.y = std::fma(disk.vy, flight, disk.y);
  disk.time = t;
  auto wrap = [&](double& position, Image& image) {
    if (position < 0) {
      position += box.length;
      --image;
    }
    // A tiny negative position plus L rounds to L itself and comes back to 0 here.
    if (position >= box.length) {
      position -= box.length;
      ++image;
    }
  };
  wrap(disk.x, image_x);
  wrap(disk.y, image_y);
}

/// Time at which the disk will have flown `box.transit` in one coordinate.
template <class Record>
[[gnu::always_inline]] inline double transit_time(const Record& disk, const Box& box) {
  const double vx = std::fabs(disk.vx), vy = std::fabs(disk.vy);
  return disk.time + box.transit / (vx > vy ? vx : vy);
}

/// What a collision contributes to the tally.
struct Impact {
  double virial;      ///< impulse times distance of the centres
  double dissipated;  ///< energy lost
};

/// The masses of two disks as a collision needs them. The reduced mass 1 / (1/m_a + 1/m_b) is kept to twice the digits
/// of a double: its rounding error would be the same in every collision of two species, and over 10^7 collisions per
/// disk elastic disks would gain or lose energy steadily instead of by a random walk of roundings.
struct PairMasses {
  double reduced, reduced_low, inverse_a, inverse_b;

  PairMasses() = default;
  PairMasses(double mass_a, double mass_b) : inverse_a(1 / mass_a), inverse_b(1 / mass_b) {
    const double larger = inverse_a > inverse_b ? inverse_a : inverse_b;
    const double sum = inverse_a + inverse_b,
                 sum_low = (inverse_a > inverse_b ? inverse_b : inverse_a) - (sum - larger);
    reduced = 1 / sum;
    reduced_low = (std::fma(-reduced, sum, 1.0) - reduced * sum_low) / sum;
  }
};

/// Collides a and b, both already advanced to the time of contact. With n the unit vector from a to b and g = v_a -
/// v_b: b gains delta = mu (1 + eps) (g.n) n, a loses it; mu = m_a m_b / (m_a + m_b); the energy lost is mu (1 - eps^2)
/// (g.n)^2 / 2. (The paper prints delta with a spurious factor 1/2.) The same bits if a and b change places.
template <class A, class B>
[[gnu::always_inline]] inline Impact collide(A& a, B& b, const PairMasses& masses, double restitution, const Box& box) {
  const double rx = box.nearest(b.x - a.x), ry = box.nearest(b.y - a.y);
  const double rr = std::fma(rx, rx, ry * ry);
  auto approach = [&] { return std::fma(rx, b.vx - a.vx, ry * (b.vy - a.vy)); };  // r.(v_b - v_a)
  auto push = [&](double impulse_over_distance) {
    const double px = impulse_over_distance * rx, py = impulse_over_distance * ry;
    a.vx -= px * masses.inverse_a;
    a.vy -= py * masses.inverse_a;
    b.vx += px * masses.inverse_b;
    b.vy += py * masses.inverse_b;
  };
  const double rv = approach();
  const double virial = -(1 + restitution) * std::fma(masses.reduced, rv, masses.reduced_low * rv);
  push(virial / rr);
  if (approach() < 0) [[unlikely]] {
    // In a grazing contact rounding may leave the pair approaching still, and it would collide again in place for
    // ever. Part it by impulses of rounding size until the very formula of contact_time says that it recedes.
    const double ulp = 0x1p-52 * ((std::fabs(a.vx) + std::fabs(a.vy)) + (std::fabs(b.vx) + std::fabs(b.vy)));
    for (double nudge = masses.reduced * ulp / std::sqrt(rr); approach() < 0; nudge *= 2) push(nudge);
  }
  return {virial, -0.5 * virial * (1 - restitution) * rv / rr};
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
