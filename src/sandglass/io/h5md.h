// H5MD trajectories, those of this program and others.
#pragma once

#include <filesystem>

#include "sandglass/io/frames.h"

namespace sandglass {

/// Opens an H5MD file [de Buyl 2014] with /particles/all/{position, box/edges} and, where they are there, image,
/// velocity, species (integers), radius, mass, id. Positions are [frame, disk, 2 or 3]; the third component is left
/// aside. The box must be a square that does not change: edges[2 or 3], or edges/value of which the first row counts.
/// Frames that were reserved but not written (step -1) end the trajectory. Steps count collisions in a file whose
/// creator is this program. Throws InputError.
RawFrames open_h5md(const std::filesystem::path& path);

/// Whether the steps of the file count collisions.
bool steps_are_collisions(const std::filesystem::path& path);

}  // namespace sandglass
