// The folder of a campaign: made from a plan, and made to hold more points later.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/study/manifest.h"
#include "sandglass/study/sweep_plan.h"

namespace sandglass {

/// What a plan means for a folder that may hold points already.
struct CampaignChange {
  Manifest manifest;                 ///< as it will be: the points that are there, then the new ones
  std::vector<Config> added;         ///< configurations of the last rows
  std::size_t kept = 0;              ///< points that were there and are in the plan
  std::vector<std::string> dropped;  ///< paths of those that are there, but no longer in the plan; they stay
};

/// What becomes of a manifest whose rows have the configurations `present`. A point is the same if all its physics keys
/// are. New ones get the next free indices and names. Throws InputError where the study now gives other physics to a
/// point that is there (the same axes and seed).
CampaignChange extend(const SweepPlan& plan, const Manifest& manifest, const std::vector<Config>& present);

/// The same for what is in a folder; writes nothing. Throws InputError also where the folder of a new point is taken or
/// the manifest is damaged.
CampaignChange plan_campaign(const SweepPlan& plan, const std::filesystem::path& folder);

/// Makes runs/NAME/config.toml of the points that are new, study.toml (a copy of `study_text`) and manifest.tsv, the
/// manifest last. Nothing that is there is touched; when it fails, what it made is removed again.
void write_campaign(const CampaignChange& change, const std::string& study_text);

}  // namespace sandglass
