// checkpoint.h5: all that a stopped run needs to go on with the same bits.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/core/state.h"

namespace sandglass {

/// The fields of one accumulator (an observer, the phase of the run) under a name of its own.
using FieldGroup = std::pair<std::string, std::vector<Field>>;

/// Writes state, configuration and accumulators to `path`, sealed by a checksum, whole or not at all. The checkpoint
/// that stood there is kept beside it as `checkpoint.previous.h5` (previous_checkpoint(path)). Throws RunError.
void write_checkpoint(const std::filesystem::path& path, const State& state, const std::string& config_toml,
                      const std::vector<FieldGroup>& groups);

struct Checkpoint {
  State state;
  std::string config_toml;
  bool from_previous = false;  ///< the newest one was missing or damaged, this is the one before it
  std::filesystem::path file;  ///< where it was found, its checksum verified
};

/// Reads the checkpoint at `path` or, where that is missing or damaged, the previous one, and restores the groups that
/// are given (a subset will do) into their fields. A vector that the observer has allocated must have its size in the
/// file; an empty one takes the size found. Throws InputError when neither can be used.
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::vector<FieldGroup>& groups);

/// Restores more groups of a checkpoint that has been read: those whose size is only known by then.
void restore_fields(const Checkpoint& checkpoint, const std::vector<FieldGroup>& groups);

/// Whether there is a checkpoint, or a previous one, to go on from.
bool has_checkpoint(const std::filesystem::path& path);

std::filesystem::path previous_checkpoint(const std::filesystem::path& path);

}  // namespace sandglass
