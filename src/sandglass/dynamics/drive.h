// The random kicks: what a ring of a disk's clock does.
#pragma once

#include <cstdint>

#include "sandglass/core/random.h"
#include "sandglass/dynamics/contact.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// All that is random in the kick number `count` (from 1) of disk `id`. One call of Philox: word 0 is the wait until
/// the next ring, words 1 and 2 the momentum, word 3 the choice among partners (PartnerRule::within).
struct Kick {
  double wait;    ///< until the next ring, times the clock's rate
  double px, py;  ///< xi: standard normal components
  std::uint64_t choice;

  static Kick draw(std::uint64_t seed, std::uint64_t id, std::uint64_t count) {
    const auto words = random_words(seed, Stream::kicks, id, count);
    const auto xi = gaussian_pair(words[1], words[2]);
    return {exponential(words[0]), xi[0], xi[1], words[3]};
  }

  /// Index of the partner among `candidates` disks ordered by id.
  [[nodiscard]] std::uint64_t pick(std::uint64_t candidates) const {
    const auto index = static_cast<std::uint64_t>(uniform(choice) * static_cast<double>(candidates));
    return index < candidates ? index : candidates - 1;
  }
};

/// Gives momentum (px, py) to a disk already advanced to the time of the kick; returns the energy gained,
/// p.v + p^2 / 2m.
template <class Record>
[[gnu::always_inline]] inline double give_momentum(Record& disk, double px, double py, double inverse_mass) {
  const double gained = px * disk.vx + py * disk.vy + 0.5 * (px * px + py * py) * inverse_mass;
  disk.vx += px * inverse_mass;
  disk.vy += py * inverse_mass;
  return gained;
}

/// Whether two disks' centres are within `reach` contact distances at time t (PartnerRule::within).
template <class A, class B>
[[gnu::always_inline]] inline bool within_reach(const A& a, const B& b, double contact, double reach, double t,
                                                const Box& box) {
  return surface_gap(a, b, contact, t, box) <= (reach - 1) * contact;
}

/// Whether the TC model makes the collision at `time` elastic: one of the disks collided less than t_c ago.
/// [Luding & McNamara 1998]
[[gnu::always_inline]] inline bool elastic_by_tc(const CollisionLaw& law, double time, double last_a, double last_b) {
  return law.collapse == CollapsePolicy::tc && (time - last_a < law.collapse_time || time - last_b < law.collapse_time);
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
