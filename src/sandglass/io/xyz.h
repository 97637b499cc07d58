// Extended XYZ trajectories.
#pragma once

#include <filesystem>

#include "sandglass/io/frames.h"

namespace sandglass {

/// Opens an extended XYZ file: per frame the number of particles, a line of key=value pairs, one line per particle. The
/// line needs Lattice="a 0 0 0 a 0 0 0 c" (a square box) and may have Properties=name:type:columns:... (default
/// species:S:1:pos:R:3) and Time=t. Columns used: pos (2 or 3 wide; the third is left aside), velo | vel | velocity |
/// velocities, species | type, id, radius, diameter, mass | masses, image. Throws InputError.
RawFrames open_xyz(const std::filesystem::path& path);

}  // namespace sandglass
