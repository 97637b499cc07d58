// The HTML page of one run, or of an analysed trajectory: figures, numbers and decisions in one file that opens
// offline.
#pragma once

#include <filesystem>
#include <string>

#include "sandglass/core/state.h"
#include "sandglass/io/summary.h"

namespace sandglass {

/// Reads what is in `run_folder` (summary.json, config.toml, observables.h5, checkpoint.h5) and writes report.html
/// there, whole or not at all. What is missing in the folder is said on the page instead of being drawn; only
/// summary.json must be there. Throws InputError when it is not, or cannot be read; RunError when the page cannot be
/// written.
void write_report(const std::filesystem::path& run_folder);

/// The same page for what was measured on stored frames: `summary`, the datasets in `folder`, and the disks of the
/// `last` frame. There is no configuration; `command` made the files.
void write_analysis_report(const std::filesystem::path& folder, const Summary& summary, const State& last,
                           const std::string& command);

}  // namespace sandglass
