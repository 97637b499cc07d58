// observables.h5, read back.
#pragma once

#include <filesystem>
#include <vector>

#include "sandglass/core/fields.h"

namespace sandglass {

/// The datasets of an observables.h5 that figures are made of; those that are not in the file are left out. Throws
/// InputError where the file cannot be read.
std::vector<Dataset> read_results(const std::filesystem::path& path);

}  // namespace sandglass
