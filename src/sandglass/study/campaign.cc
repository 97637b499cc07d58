#include "sandglass/study/campaign.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <fstream>
#include <unordered_map>
#include <unordered_set>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"

namespace sandglass {
namespace {

/// What a user sees of a point: the axes of the plan and the seed.
std::string label(const SweepPlan& plan, const Config& config) {
  std::string text;
  for (const std::string& axis : plan.axes) text += fmt::format("{} = {}, ", axis, value_text(config, axis));
  return text + fmt::format("run.seed = {}", config.run.seed);
}

class Comparison {
 public:
  Comparison(const SweepPlan& plan, const Manifest& manifest, const std::vector<Config>& present)
      : plan_(plan), manifest_(manifest), present_(present), in_plan_(present.size(), false) {
    for (std::size_t i = 0; i < present.size(); ++i) {
      by_physics_.emplace(physics_text(present[i]), i);
      by_label_.emplace(label(plan, present[i]), i);
    }
  }

  /// Whether the point is there already.
  bool known(const Config& config) {
    const auto same = by_physics_.find(physics_text(config));
    if (same != by_physics_.end()) return in_plan_[same->second] = true;
    const auto alike = by_label_.find(label(plan_, config));
    if (alike != by_label_.end()) refuse_change(config, alike->second);
    return false;
  }

  [[nodiscard]] std::vector<std::string> dropped() const {
    std::vector<std::string> paths;
    for (std::size_t i = 0; i < in_plan_.size(); ++i)
      if (!in_plan_[i]) paths.push_back(manifest_.rows[i].path);
    return paths;
  }

 private:
  [[noreturn]] void refuse_change(const Config& config, std::size_t row) const {
    std::vector<std::string> changes;
    for (const std::string& key : differing_keys(config, present_[row]))
      changes.push_back(
          fmt::format("{} was {} and would be {}", key, value_text(present_[row], key), value_text(config, key)));
    throw InputError(fmt::format(
        "{}: this point of the campaign would become another run ({}). Results that are there are not mixed with those "
        "of other physics: give the values of before, or another folder with -o",
        manifest_.run_folder(manifest_.rows[row]).string(), fmt::join(changes, "; ")));
  }

  const SweepPlan& plan_;
  const Manifest& manifest_;
  const std::vector<Config>& present_;
  std::vector<bool> in_plan_;
  std::unordered_map<std::string, std::size_t> by_physics_, by_label_;
};

/// Axes of before come first and stay, so that columns only ever grow.
std::vector<std::string> joined(std::vector<std::string> axes, const std::vector<std::string>& more) {
  for (const std::string& axis : more)
    if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
  return axes;
}

ManifestRow row_of(const Config& config, std::uint64_t index, std::string path, const std::vector<std::string>& axes) {
  ManifestRow row{.index = index, .path = std::move(path), .seed = config.run.seed, .values = {}};
  for (const std::string& axis : axes) row.values.push_back(value_text(config, axis));
  return row;
}

/// A folder that is there but in no manifest is taken over if it holds this very run (a sweep init that was killed, a
/// line that was deleted), else it is in the way.
void check_place(const std::filesystem::path& folder, const Config& config) {
  if (!std::filesystem::exists(folder)) return;
  const std::filesystem::path file = folder / "config.toml";
  if (!std::filesystem::exists(file) && std::filesystem::is_directory(folder) && std::filesystem::is_empty(folder))
    return;
  if (std::filesystem::exists(file) && differing_keys(config, read_config(file)).empty()) return;
  throw InputError(
      fmt::format("{} is there already and holds something else: move it away or give another folder with "
                  "-o",
                  folder.string()));
}

}  // namespace

CampaignChange extend(const SweepPlan& plan, const Manifest& manifest, const std::vector<Config>& present) {
  CampaignChange change;
  change.manifest.folder = manifest.folder;
  change.manifest.axes = joined(manifest.axes, plan.axes);
  std::uint64_t last_index = 0;
  std::unordered_set<std::string> taken;
  for (std::size_t i = 0; i < present.size(); ++i) {
    const ManifestRow& row = manifest.rows[i];
    change.manifest.rows.push_back(row_of(present[i], row.index, row.path, change.manifest.axes));
    last_index = std::max(last_index, row.index);
    taken.insert(row.path);
  }

  Comparison comparison(plan, manifest, present);
  const std::vector<std::string> names = point_names(plan);
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    if (comparison.known(plan.points[i])) {
      ++change.kept;
      continue;
    }
    std::string path = "runs/" + names[i];
    for (int copy = 2; !taken.insert(path).second; ++copy) path = fmt::format("runs/{}-{}", names[i], copy);
    change.manifest.rows.push_back(row_of(plan.points[i], ++last_index, path, change.manifest.axes));
    change.added.push_back(plan.points[i]);
  }
  change.dropped = comparison.dropped();
  return change;
}

CampaignChange plan_campaign(const SweepPlan& plan, const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "config.toml"))
    throw InputError(fmt::format("{} holds a single run: give another folder with -o", folder.string()));
  Manifest manifest{.folder = folder, .axes = {}, .rows = {}};
  if (std::filesystem::exists(manifest_in(folder))) manifest = read_manifest(manifest_in(folder));
  std::vector<Config> present;
  for (const ManifestRow& row : manifest.rows) present.push_back(read_point(manifest, row));
  CampaignChange change = extend(plan, manifest, present);
  const std::size_t first = manifest.rows.size();
  for (std::size_t i = 0; i < change.added.size(); ++i)
    check_place(change.manifest.run_folder(change.manifest.rows[first + i]), change.added[i]);
  return change;
}

namespace {

/// Files and folders made so far; they go again unless all is well.
class Undo {
 public:
  Undo() = default;
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  ~Undo() {
    std::error_code error;
    for (auto path = made_.rbegin(); path != made_.rend(); ++path) std::filesystem::remove(*path, error);
  }
  void add(std::filesystem::path path) { made_.push_back(std::move(path)); }
  void forget() { made_.clear(); }

 private:
  std::vector<std::filesystem::path> made_;
};

void make_folder(const std::filesystem::path& folder, Undo& undo) {
  std::error_code error;
  if (std::filesystem::create_directory(folder, error)) undo.add(folder);
  if (error) fail_to_write(folder, error.value());
}

/// A new file. It is not waited for to be on the disk: ten thousand of them would take minutes.
void write_new(const std::filesystem::path& path, const std::string& text, Undo& undo) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  if (file) undo.add(path);
  file << text;
  file.close();
  if (!file) fail_to_write(path, errno == 0 ? EIO : errno);
}

}  // namespace

void write_campaign(const CampaignChange& change, const std::string& study_text) {
  const Manifest& manifest = change.manifest;
  Undo undo;
  make_folder(manifest.folder / "runs", undo);
  const std::size_t first = manifest.rows.size() - change.added.size();
  for (std::size_t i = 0; i < change.added.size(); ++i) {
    const std::filesystem::path folder = manifest.run_folder(manifest.rows[first + i]);
    make_folder(folder, undo);
    if (!std::filesystem::exists(folder / "config.toml"))
      write_new(folder / "config.toml", config_to_toml(change.added[i]), undo);
  }
  write_whole(manifest.folder / "study.toml", study_text);
  write_manifest(manifest_in(manifest.folder), manifest);
  undo.forget();
}

}  // namespace sandglass
