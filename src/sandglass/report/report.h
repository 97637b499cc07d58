// The HTML page of one run: figures, numbers and decisions in one file that opens offline.
#pragma once

#include <filesystem>

namespace sandglass {

/// Reads what is in `run_folder` (summary.json, config.toml, observables.h5, checkpoint.h5) and writes report.html
/// there, whole or not at all. What is missing in the folder is said on the page instead of being drawn; only
/// summary.json must be there. Throws InputError when it is not, or cannot be read; RunError when the page cannot be
/// written.
void write_report(const std::filesystem::path& run_folder);

}  // namespace sandglass
