// trajectory.h5: frames of all disks in the H5MD layout (https://h5md.nongnu.org), D = 2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// Makes the file with room for all its frames, every `step` -1 and every `time` NaN until its frame is written. The
/// structure is complete from here on and frames are written into their places, so that a kill at any moment leaves a
/// readable file. Throws RunError (full disk) or InputError (folder not writable).
void create_trajectory(const std::filesystem::path& path, const State& state, std::uint64_t frames);

/// Writes frame `index`. `step` (>= 0) counts what the run counts, by convention its collisions. Unwrapped coordinates
/// are split into a position in [0, box_length) and image counts. Throws RunError; InputError when the file is not such
/// a trajectory.
void write_frame(const std::filesystem::path& path, std::uint64_t index, std::int64_t step, const Frame& frame,
                 double box_length);

/// Refuses a file into whose places frames of this run cannot be written. It is looked at in a process of its own
/// (io/apart.h). Throws InputError.
void check_trajectory(const std::filesystem::path& path, std::size_t disks, std::uint64_t frames);

/// What stands beside a frame, at its index in `frame_checksums`, so that damage is known when it is read: over
/// positions, velocities and image counts as they are stored, time and step.
inline constexpr const char* frame_checksums = "/parameters/frame_checksum";

/// What is said where it is wrong.
std::string wrong_checksum(std::uint64_t frame);

/// The last complete frame as a State at time 0: box, mixture, disks; everything else has its defaults. Throws
/// InputError.
State read_last_frame(const std::filesystem::path& path);

/// An unwrapped coordinate as position in [0, L) plus image * L.
struct Wrapped {
  double position = 0;
  std::int32_t image = 0;
};
Wrapped wrap(double coordinate, double box_length);

}  // namespace sandglass
