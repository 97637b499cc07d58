// How fast the engine is at one state point, and a check that it is fast at the right physics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/io/config.h"
#include "sandglass/study/self_check.h"

namespace sandglass {

/// What to measure. The trajectory, and so the state hash, is a function of these alone.
struct BenchmarkPlan {
  Config config;                       ///< the state point: system, collision, drive, prepare, seed
  double age = 100;                    ///< collisions per disk before measuring
  std::optional<double> collisions{};  ///< per disk, in all repeats together; none: default_collisions
  std::uint64_t repeats = 5;           ///< stretches, timed one by one
};

/// 2 * 10^7 collisions in all, some seconds, but at least 5 per disk.
double default_collisions(std::size_t particles);

struct Benchmark {
  std::size_t tiles_per_side = 1;                 ///< the start was prepared as a tile and repeated
  double kick_frequency = 0, kick_amplitude = 0;  ///< as calibrated; 0 without drive
  double aged = 0, measured = 0;                  ///< collisions per disk before, and in the timed stretches
  std::vector<double> rates;                      ///< collisions per second of wall clock, one per repeat
  double wall_seconds = 0, cpu_seconds = 0;
  // Over the whole measured stretch: the timed parts and, between them, those in which the self-check looks on.
  Tally events;                         ///< counts; the sums are left out
  Simulation::Bookkeeping bookkeeping;  ///< what the engine did besides
  unsigned threads = 1;                 ///< that worked on the trajectory
  double temperature = 0;               ///< at the end
  double bytes_per_disk = 0;            ///< memory that the process holds while it runs
  double peak_bytes_per_disk = 0;       ///< the most it ever held, preparation and self-check included
  std::string state_hash;
  std::vector<CheckedFigure> check;
};

/// Prepares, ages, and measures; then checks. The start is one tile of about 10^4 disks, repeated periodically, every
/// disk with a velocity of its own; the whole is prepared at once where N has no such divisor (tiles_per_side). The
/// drive is calibrated on the tile, to 1 % of T. Stretches are fixed lengths of physical time, by the collision rate in
/// the second half of ageing; only the engine's own work is timed.
/// Throws InputError for undriven inelastic disks, which cool and cluster, for those below least_checked_restitution,
/// and for what check_config refuses.
Benchmark run_benchmark(const BenchmarkPlan& plan, const Progress& progress = {});

}  // namespace sandglass
