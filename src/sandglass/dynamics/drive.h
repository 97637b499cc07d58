// The random kicks: what a ring of a disk's clock does.
#pragma once

#include <cmath>
#include <cstdint>

#include "sandglass/core/portable_functions.h"
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

  /// Its wait alone.
  static double draw_wait(std::uint64_t seed, std::uint64_t id, std::uint64_t count) {
    return exponential(random_words(seed, Stream::kicks, id, count)[0]);
  }

  /// Index of the partner among `candidates` disks ordered by id.
  [[nodiscard]] std::uint64_t pick(std::uint64_t candidates) const {
    const auto index = static_cast<std::uint64_t>(uniform(choice) * static_cast<double>(candidates));
    return index < candidates ? index : candidates - 1;
  }
};

/// Some kicks drawn together. A kick is a function of the disk and its number alone, so it may be drawn before its time
/// has come; the compiler does the arithmetic of all in one vector (the same operations as Kick::draw, the same bits).
struct DrawnKicks {
  static constexpr std::uint32_t size = 8;
  alignas(32) std::uint32_t slot[size];
  std::uint64_t id[size], count[size];  ///< whose kick, and which
  double wait[size], px[size], py[size];
  std::uint64_t choice[size];

  void draw(std::uint64_t seed) {
    std::uint64_t words[3][size];
    for (std::uint32_t n = 0; n < size; ++n) {
      const auto drawn = random_words(seed, Stream::kicks, id[n], count[n]);
      words[0][n] = drawn[0], words[1][n] = drawn[1], words[2][n] = drawn[2], choice[n] = drawn[3];
    }
    for (std::uint32_t n = 0; n < size; ++n) {
      wait[n] = -log_of(uniform_of(words[0][n]));
      const double radius = std::sqrt(2 * -log_of(uniform_of(words[1][n])));
      const SineCosine angle = sincos_of_turns(uniform_of(words[2][n]));
      px[n] = radius * angle.cosine;
      py[n] = radius * angle.sine;
    }
  }

  [[nodiscard]] Kick kick(std::uint32_t n) const { return {wait[n], px[n], py[n], choice[n]}; }
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
