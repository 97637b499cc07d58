// From a configuration to the state a run starts from.
#pragma once

#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"
#include "sandglass/io/config.h"

namespace sandglass {

/// The beat of a run: one mean free time by the formula (Enskog, at the wanted temperature). Everything that the
/// program decides during a run, it decides at multiples of the beat; an epoch is 1024 of them.
double beat_of(const Config& config);

/// Small and big disks.
struct Counts {
  std::size_t small, big;
};
Counts counts_of(const Config& config);

/// The same fluid with fewer disks: as few as a run can have from `least` on; `config` itself if it has no more.
Config smaller_config(const Config& config, std::uint64_t least);

/// What the drive is calibrated with. Its frequency and amplitude do not depend on the size of the system, and 10^5
/// disks tell the temperature to 0.2 % in any window: a larger system is not run for that. One from a file is, since
/// nobody knows how to make a smaller one like it. Without a drive, `config` itself.
Config calibration_config(const Config& config);

/// Disks in place by the wanted method, Gaussian velocities at the wanted temperature with no total momentum,
/// collision law, and the drive at the first guess of frequency and amplitude (for calibration to improve), clocks
/// running, time 0.
State make_start(const Config& config, const Progress& progress = {});

}  // namespace sandglass
