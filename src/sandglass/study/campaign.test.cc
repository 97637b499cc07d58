#include "sandglass/study/campaign.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <rapidcheck.h>

#include <map>
#include <set>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

SweepPlan plan_of(const std::string& text) { return read_study_text(text, "study.toml", "/folder"); }

/// Makes or extends the campaign in `folder`; what changed.
CampaignChange init(const std::string& study, const std::filesystem::path& folder) {
  CampaignChange change = plan_campaign(plan_of(study), folder);
  write_campaign(change, study);
  return change;
}

std::string product(const std::set<int>& densities, const std::string& more = "") {
  std::string list;
  for (const int density : densities) list += fmt::format("0.{}, ", density);
  return fmt::format("{}\n[[sweep.product]]\nsystem.packing_fraction = [{}]\n", more, list);
}

std::map<std::string, std::uint64_t> indices(const Manifest& manifest) {
  std::map<std::string, std::uint64_t> found;
  for (const ManifestRow& row : manifest.rows) found[row.values.front()] = row.index;
  return found;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string refusal(const std::string& study, const std::filesystem::path& folder) {
  return message_of<InputError>([&] { init(study, folder); });
}

}  // namespace

TEST_CASE("a new campaign has a folder with the complete configuration of each point, and a manifest") {
  const TemporaryFolder folder;
  const std::string study = product({50, 60}, "[sweep]\nreplicas = 2");
  CHECK(init(study, folder.path()).added.size() == 4);
  CHECK(slurp(folder / "study.toml") == study);
  CHECK(slurp(folder / "manifest.tsv") ==
        "index\tpath\tseed\tsystem.packing_fraction\n1\truns/eta=0.50_seed=1\t1\t0.5\n2\truns/eta=0.50_seed=2\t2\t0.5\n"
        "3\truns/eta=0.60_seed=1\t1\t0.6\n4\truns/eta=0.60_seed=2\t2\t0.6\n");
  const Manifest manifest = read_manifest(folder / "manifest.tsv");
  for (const ManifestRow& row : manifest.rows) {
    const Config config = read_point(manifest, row);
    CHECK(slurp(manifest.run_folder(row) / "config.toml") == config_to_toml(config));
  }
}

TEST_CASE("more points keep indices and folders of those that are there") {
  CHECK(rc::check("stability", [] {
    const auto two_digits = rc::gen::inRange(10, 60);
    const auto first = *rc::gen::nonEmpty(rc::gen::container<std::set<int>>(two_digits));
    const auto more = *rc::gen::container<std::set<int>>(two_digits);
    const SweepPlan plan = plan_of(product(first));
    const Manifest before = extend(plan, {}, {}).manifest;

    std::set<int> all = first;
    all.insert(more.begin(), more.end());
    const CampaignChange change = extend(plan_of(product(all)), before, plan.points);
    const Manifest& after = change.manifest;
    RC_ASSERT(change.kept == first.size());
    RC_ASSERT(change.added.size() == all.size() - first.size());
    RC_ASSERT(after.rows.size() == all.size());
    for (std::size_t i = 0; i < before.rows.size(); ++i) {
      RC_ASSERT(after.rows[i].index == before.rows[i].index);
      RC_ASSERT(after.rows[i].path == before.rows[i].path);
    }
    std::set<std::uint64_t> seen;
    for (const ManifestRow& row : after.rows) seen.insert(row.index);
    RC_ASSERT(*seen.begin() == 1 && *seen.rbegin() == all.size() && seen.size() == all.size());
  }));
}

TEST_CASE("init again touches nothing of a point that is there") {
  const TemporaryFolder folder;
  init(product({50, 60}), folder.path());
  spill(folder / "runs/eta=0.50_seed=1/summary.json", "results");
  const auto time = std::filesystem::last_write_time(folder / "runs/eta=0.50_seed=1/config.toml");
  CHECK(init(product({50, 55, 60}), folder.path()).added.size() == 1);
  CHECK(init(product({50, 55, 60}), folder.path()).added.empty());
  CHECK(slurp(folder / "runs/eta=0.50_seed=1/summary.json") == "results");
  CHECK(std::filesystem::last_write_time(folder / "runs/eta=0.50_seed=1/config.toml") == time);
}

TEST_CASE("an axis that comes later gets a column; points of before keep their names") {
  const TemporaryFolder folder;
  init(product({50, 60}), folder.path());
  init(product({50, 60}) + "collision.restitution = [0.9, 0.725]\n", folder.path());
  const Manifest manifest = read_manifest(folder / "manifest.tsv");
  CHECK(manifest.axes == std::vector<std::string>{"system.packing_fraction", "collision.restitution"});
  CHECK(manifest.rows[0].path == "runs/eta=0.50_seed=1");
  CHECK(manifest.rows[0].values == std::vector<std::string>{"0.5", "0.9"});
  CHECK(manifest.rows[2].path == "runs/eta=0.50_eps=0.725_seed=1");
}

TEST_CASE("a point that would become another run is refused by what differs; nothing is written") {
  const TemporaryFolder folder;
  init(product({50, 60}), folder.path());
  const std::string before = slurp(folder / "manifest.tsv");
  const std::string message = refusal(product({50, 65}, "run.collisions = 77"), folder.path());
  CHECK(contains(message, "run.collisions was 10000 and would be 77"));
  CHECK(contains(message, "eta=0.50_seed=1"));
  // Also where the names differ, because there are more digits now.
  CHECK(
      contains(refusal("run.collisions = 77\n[[sweep.product]]\nsystem.packing_fraction = [0.5, 0.625]", folder.path()),
               "run.collisions"));
  CHECK(slurp(folder / "manifest.tsv") == before);
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "runs"), {}) == 2);
  // What is no physics may change: the runs that are there keep what they have.
  CHECK(init(product({50, 60}, "output.checkpoint_seconds = 7"), folder.path()).added.empty());
}

TEST_CASE("points that leave the study stay and are named; a deleted line is taken up again") {
  const TemporaryFolder folder;
  init(product({50, 60}), folder.path());
  const CampaignChange change = init(product({60, 70}), folder.path());
  CHECK(change.dropped == std::vector<std::string>{"runs/eta=0.50_seed=1"});
  CHECK(change.added.size() == 1);
  Manifest manifest = read_manifest(folder / "manifest.tsv");
  CHECK(manifest.rows.size() == 3);
  manifest.rows.erase(manifest.rows.begin());
  write_manifest(manifest_in(folder.path()), manifest);
  CHECK(init(product({50, 60, 70}), folder.path()).added.size() == 1);
  CHECK(indices(read_manifest(folder / "manifest.tsv")) ==
        std::map<std::string, std::uint64_t>{{"0.5", 4}, {"0.6", 2}, {"0.7", 3}});
}

TEST_CASE("what is in the way is refused and left alone") {
  const TemporaryFolder folder;
  spill(folder / "config.toml", "");
  CHECK(contains(refusal(product({50}), folder.path()), "holds a single run"));
  std::filesystem::remove(folder / "config.toml");
  std::filesystem::create_directories(folder / "runs/eta=0.60_seed=1");
  spill(folder / "runs/eta=0.60_seed=1/notes.txt", "mine");
  CHECK(contains(refusal(product({50, 60}), folder.path()), "holds something else"));
  CHECK(!std::filesystem::exists(folder / "manifest.tsv"));
  CHECK(!std::filesystem::exists(folder / "runs/eta=0.50_seed=1"));
}

TEST_CASE("where a folder cannot be made, those that were are removed again") {
  const TemporaryFolder folder;
  CampaignChange change = plan_campaign(plan_of(product({50, 60})), folder.path());
  change.manifest.rows.back().path = "runs/" + std::string(300, 'x');  // longer than a name may be
  CHECK(!message_of<InputError>([&] { write_campaign(change, ""); }).empty());
  CHECK(std::filesystem::is_empty(folder.path()));
}
