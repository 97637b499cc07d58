// What the statistical checks share: start states, measured stretches, averages with standard errors.
//
// How tolerances are made: a stretch is cut into blocks longer than the memory of what is averaged, their mean has the
// standard error sigma known from the scatter of the blocks, and a check allows 4.5 sigma plus what the theory it is
// held against is known to be wrong by. With 40 blocks (Student's t) a right program fails one such check in 17 000.
// Seeds are fixed, so a check that has passed once passes until the program changes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/prepare/prepare.h"
#include "sandglass/theory/enskog.h"

namespace sandglass::physics {

inline constexpr double allowed_sigmas = 4.5;
inline constexpr int block_count = 40;

/// Disks of radius 1 and `size_ratio` of one mass density.
inline Mixture mixture_of(double size_ratio) { return {{1, size_ratio}, {1, size_ratio * size_ratio}}; }

/// Half small, half big disks at T = 1, elastic and undriven. Epochs last 1000 mean free times.
inline State start(double size_ratio, std::size_t particles, double packing_fraction, std::uint64_t seed) {
  const Mixture mixture = mixture_of(size_ratio);
  const std::size_t half = particles / 2;
  State state = packing_fraction <= insert_limit
                    ? insert_disks(half, particles - half, mixture, packing_fraction, seed)
                    : quench_disks(half, particles - half, mixture, packing_fraction, seed);
  state.seed = seed;
  state.epoch_length = 1000 * mean_free_time(mixture, 0.5, packing_fraction, 1);
  draw_velocities(state, 1);
  return state;
}

/// Drives the disks of `state` so that the Enskog balance gives T = 1, with `kicks_per_collision` kicks of a disk for
/// each of its collisions.
inline void drive(State& state, DriveKind kind, double restitution, double kicks_per_collision = 1) {
  const auto steady =
      driven_steady_state(state.mixture, 0.5, packing_fraction(state), restitution, 1, kicks_per_collision);
  state.collision.restitution = restitution;
  state.drive.kind = kind;
  state.drive.frequency = kicks_per_collision * steady.rates.mean;
  state.drive.amplitude = steady.amplitude;
  start_kick_clocks(state);
}

/// Mean of independent values and its standard error.
class Average {
 public:
  void add(double value) {
    count_ += 1;
    const double step = value - mean_;
    mean_ += step / count_;
    squares_ += step * (value - mean_);
  }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double error() const { return std::sqrt(squares_ / (count_ * (count_ - 1))); }
  /// How many standard errors the mean is farther from `expected` than the `systematic` error allowed.
  [[nodiscard]] double sigmas_from(double expected, double systematic = 0) const {
    return (std::fabs(mean_ - expected) - systematic) / error();
  }

 private:
  double count_ = 0, mean_ = 0, squares_ = 0;
};

/// What the events of a stretch of time say, half of the disks being big.
struct Stretch {
  PairValues rates{};  ///< omega_ij
  double rate = 0;     ///< mean omega per disk
  double virial = 0;   ///< sum of impulse times distance / (2 N t), which is (Z - 1) T
};

/// Runs for `duration` and returns what happened; calls `look` at the ends of `looks` equal parts of it.
template <class Look>
Stretch run_stretch(Simulation& simulation, double duration, int looks, Look&& look) {
  const Tally before = simulation.tally();
  const double begin = simulation.time();
  for (int part = 1; part <= looks; ++part) {
    simulation.run_until(begin + duration * part / looks);
    look();
  }
  const Tally& after = simulation.tally();
  const auto particles = static_cast<double>(simulation.size());
  const auto contacts = [&](int pair) { return static_cast<double>(after.contacts[pair] - before.contacts[pair]); };
  const double half_time = particles / 2 * duration;
  Stretch stretch;
  stretch.rates[small] = {2 * contacts(0) / half_time, contacts(1) / half_time};
  stretch.rates[big] = {contacts(1) / half_time, 2 * contacts(2) / half_time};
  stretch.rate = (contacts(0) + contacts(1) + contacts(2)) / half_time;
  stretch.virial = (after.virial.value() - before.virial.value()) / (2 * particles * duration);
  return stretch;
}

inline Stretch run_stretch(Simulation& simulation, double duration) {
  return run_stretch(simulation, duration, 1, [] {});
}

/// `count` frames, one now and the others `interval` apart.
inline std::vector<Frame> record(Simulation& simulation, double interval, std::size_t count) {
  std::vector<Frame> frames(count);
  const double first = simulation.time();
  for (std::size_t k = 0; k < count; ++k) {
    simulation.run_until(first + static_cast<double>(k) * interval);
    simulation.make_frame(frames[k]);
  }
  return frames;
}

}  // namespace sandglass::physics
