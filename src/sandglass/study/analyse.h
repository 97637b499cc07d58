// The measurements of a run, made on stored frames instead.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"
#include "sandglass/io/frames.h"
#include "sandglass/io/summary.h"

namespace sandglass {

struct AnalysisOptions {
  FrameOptions frames;
  std::uint64_t from = 0;    ///< first frame used
  std::uint64_t stride = 1;  ///< every so manieth frame after it
  std::uint64_t blocks = 0;  ///< intervals whose scatter gives the errors; 0: ten, two where frames are few
  std::vector<double> wavenumbers{0.5, 3.0};
  double lags_per_decade = 12, overlap_length = 0.6, selection_time = 0, bin_width = 0;
  std::array<double, 2> exponent_range{1, 10};  ///< times between which the exponent of the MSD is fitted
};

struct Analysis {
  Summary summary;
  State last;  ///< where the disks of the last frame used are
};

/// Reads `trajectory` twice (frames and times first) and writes observables.h5 and summary.json into `folder`. Static
/// structure is taken of every frame; time correlations within each of the blocks, all frames being origins (every so
/// manieth with more than 128 frames in a block), with the estimators and the datasets of a run. Frames must be evenly
/// spaced in time. What frames do not hold (collisions, kicks, velocities that are not stored) is unknown in the
/// summary and left out of observables.h5. Throws InputError.
Analysis analyse(const std::filesystem::path& trajectory, const std::filesystem::path& folder,
                 const AnalysisOptions& options, const Progress& progress = {});

}  // namespace sandglass
