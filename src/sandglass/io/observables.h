// observables.h5: the results of a run.
#pragma once

#include <filesystem>
#include <vector>

#include "sandglass/core/fields.h"

namespace sandglass {

/// Writes every dataset at its path, groups made on the way, each with an attribute `unit` and those it has of its
/// own; the file is sealed by a checksum and replaced whole or not at all. Throws RunError; std::logic_error when a
/// shape does not fit its values.
void write_observables(const std::filesystem::path& path, const std::vector<Dataset>& datasets);

}  // namespace sandglass
