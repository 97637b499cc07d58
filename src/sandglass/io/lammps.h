// LAMMPS trajectories (dump files in text form).
#pragma once

#include <filesystem>

#include "sandglass/io/frames.h"

namespace sandglass {

/// Opens a dump of style `atom` or `custom`. Columns used: id, type, x y | xu yu (unwrapped) | xs ys (scaled) | xsu
/// ysu, ix iy, vx vy, radius or diameter, mass. The box must be a square in x and y and not tilted; z is left aside.
/// Times come from ITEM: TIME where it is there. Throws InputError.
RawFrames open_lammps(const std::filesystem::path& path);

}  // namespace sandglass
