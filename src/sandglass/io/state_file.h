// A State in an HDF5 file: every field, exact bits.
#pragma once

#include <filesystem>

#include "sandglass/core/state.h"

namespace sandglass {

class Hdf5File;

/// Writes `state` to a file of its own, sealed by a checksum, whole or not at all. Throws RunError or InputError.
void write_state(const std::filesystem::path& path, const State& state);

/// Reads what write_state (or write_checkpoint) wrote and validates it: checksum, shapes, finite numbers, times not in
/// the future, species 0 or 1. Throws InputError.
State read_state(const std::filesystem::path& path);

/// A start for a run, from a state file, a checkpoint or a trajectory (its last complete frame). Of a trajectory only
/// box, disks, time 0 and the mixture are known; the rest of the State has its defaults. Throws InputError.
State read_start_file(const std::filesystem::path& path);

/// The same within an open file, in the group /state.
void write_state(Hdf5File& file, const State& state);
State read_state(const Hdf5File& file);

}  // namespace sandglass
