// What the page of a run says: the plain-language result, the numbers and their errors, the decisions.
#pragma once

#include <string>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/io/summary.h"
#include "sandglass/report/page.h"

namespace sandglass {

/// What a run left behind. A part that could not be read is empty, and its `..._missing` says why.
struct RunRecord {
  Summary summary;
  std::string config_toml;
  std::vector<Dataset> results;
  std::string results_missing;
  std::optional<Packing> packing;
  std::string packing_missing;
  std::string command = "sandglass run config.toml -o again";  ///< that makes it again
};

Page run_page(const RunRecord& run);

/// Of frames that were analysed: what only a run knows is left out.
Page analysis_page(const RunRecord& analysis);

}  // namespace sandglass
