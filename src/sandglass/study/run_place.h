// Where a run stands between two beats: what of it, beside State and observers, a checkpoint keeps.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/core/state.h"
#include "sandglass/io/config.h"
#include "sandglass/observe/schedule.h"

namespace sandglass {

struct RunPlace {
  std::uint64_t calibrating = 0;     ///< 1 while the drive is being calibrated
  std::uint64_t beats = 0;           ///< done since t = 0
  std::uint64_t measuring = 0;       ///< 1 once equilibration is over
  std::uint64_t first_beat = 0;      ///< of the measured stretch
  std::uint64_t measured_beats = 0;  ///< length of the measured stretch

  /// s at the last two powers of two of beats. The collision rate of the fluid is taken from the earlier mark on: over
  /// the last half to three quarters of equilibration, whatever its length.
  struct Marks {
    std::uint64_t early_beats = 0, late_beats = 1;
    double early_collisions = 0, late_collisions = 0;
  } marks;

  [[nodiscard]] std::vector<Field> fields();
};

/// A checkpoint's State and place are followed without question, so they are questioned first: whether such a State can
/// be of a run of `config`, whose beat is `beat`, and whether it is at that place. Throws InputError.
void check_place(const RunPlace& place, const State& state, const Config& config, double beat);

/// The same for the plan of a measurement that has begun.
void check_place(const RunPlace& place, const MeasurementPlan& plan, double beat);

}  // namespace sandglass
