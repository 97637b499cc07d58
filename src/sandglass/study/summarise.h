// A finished run in numbers and sentences.
#pragma once

#include <array>

#include "sandglass/core/state.h"
#include "sandglass/io/config.h"
#include "sandglass/io/summary.h"
#include "sandglass/study/calibrate.h"
#include "sandglass/study/measurement.h"

namespace sandglass {

/// What only the run itself knows.
struct RunFacts {
  Calibration calibration;
  double start_energy = 0, end_energy = 0;  ///< kinetic energy of all disks at both ends of the measured stretch
  double wall_seconds = 0;
  double collisions_per_second = 0;
  unsigned threads = 1;  ///< that worked on the trajectory
};

/// Why fewer threads were used than asked for: a sentence for the user.
std::string fewer_threads(const Config& config, unsigned used);

/// The summary, with what the program decided by itself and what the reader must be warned of.
Summary summarise(const Config& config, const State& end, const Measurement& measurement, const RunFacts& facts);

/// The part of a summary that frames alone allow: motion, with the exponent of the MSD between two times, relaxation,
/// structure.
void summarise_frames(const Correlator& correlator, const StructureSampler& structure,
                      std::array<double, 2> exponent_range, Summary& summary);

}  // namespace sandglass
