#include "sandglass/study/sweep_plan.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_set>

#include "sandglass/core/errors.h"
#include "sandglass/io/config_table.h"

namespace sandglass {
namespace {

constexpr double most_points = 1e5;
constexpr std::uint64_t most_replicas = 10000;
constexpr std::uint64_t largest_seed = std::numeric_limits<std::int64_t>::max();  // that TOML can write

/// A key with one value, or with the list of those it takes.
struct Setting {
  const Key* key = nullptr;
  std::vector<const toml::node*> values{};
  toml::source_position at{};
  bool listed = false;  ///< an axis, even with one value
};

enum class BlockKind { product, zip, point };

struct Block {
  BlockKind kind = BlockKind::point;
  std::string place{};
  std::vector<Setting> axes{}, plain{};
  std::optional<std::uint64_t> replicas{};

  /// Number of points, without replicas.
  [[nodiscard]] double size() const {
    if (axes.empty()) return 1;
    if (kind == BlockKind::zip) return static_cast<double>(axes.front().values.size());
    double size = 1;
    for (const Setting& axis : axes) size *= static_cast<double>(axis.values.size());
    return size;
  }
};

class Reader {
 public:
  Reader(std::string name, std::filesystem::path folder) : name_(std::move(name)), folder_(std::move(folder)) {}

  /// The blocks of [sweep], in the order of the file.
  std::vector<Block> blocks(const toml::table& sweep) const {
    std::vector<std::pair<toml::source_position, Block>> found;
    std::optional<std::uint64_t> replicas;
    for (const auto& [key, node] : sweep) {
      const std::string word(key.str()), place = at(key.source());
      if (word == "replicas") {
        replicas = read_replicas(node);
        continue;
      }
      const auto kind = word == "product" ? BlockKind::product : word == "zip" ? BlockKind::zip : BlockKind::point;
      if (kind == BlockKind::point && word != "point")
        throw InputError(fmt::format(
            "{}: [sweep] has no key {}: it takes replicas and the blocks [[sweep.product]], [[sweep.zip]] and "
            "[[sweep.point]]",
            place, word));
      const auto* list = node.as_array();
      if (list == nullptr || !list->is_array_of_tables())
        throw InputError(fmt::format("{0}: write [[sweep.{1}]], with two brackets: there may be several", place, word));
      for (const toml::node& table : *list) found.emplace_back(table.source().begin, block(kind, *table.as_table()));
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
      return std::tie(a.first.line, a.first.column) < std::tie(b.first.line, b.first.column);
    });
    std::vector<Block> blocks;
    for (auto& [position, block] : found) blocks.push_back(std::move(block));
    if (blocks.empty()) blocks.push_back({.place = name_});  // only replicas
    for (Block& block : blocks)
      if (!block.replicas) block.replicas = replicas.value_or(1);
    return blocks;
  }

  void set(Config& config, const Setting& setting, std::size_t index) const {
    const toml::node& node = *setting.values[index];
    setting.key->read(config, *setting.key, {node, at(node.source()), "", folder_});
  }

 private:
  [[nodiscard]] std::string at(const toml::source_region& region) const { return locate(name_, region.begin); }

  std::uint64_t read_replicas(const toml::node& node) const {
    const auto* whole = node.as_integer();
    if (whole == nullptr || whole->get() < 1 || whole->get() > static_cast<std::int64_t>(most_replicas))
      throw InputError(fmt::format("{}: replicas must be a whole number in [1, {}]", at(node.source()), most_replicas));
    return static_cast<std::uint64_t>(whole->get());
  }

  Block block(BlockKind kind, const toml::table& table) const {
    Block block{.kind = kind, .place = at(table.source())};
    std::vector<Setting> settings;
    for (const auto& [key, node] : table) {
      const std::string word(key.str());
      if (word == "replicas") {
        block.replicas = read_replicas(node);
      } else if (const auto* section = node.as_table()) {  // system.packing_fraction = ..., a table within a table
        for (const auto& [leaf, inner] : *section)
          settings.push_back(setting(kind, word + '.' + std::string(leaf.str()), leaf.source(), inner));
      } else {
        settings.push_back(setting(kind, word, key.source(), node));
      }
    }
    std::sort(settings.begin(), settings.end(), [](const Setting& a, const Setting& b) {
      return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
    });
    for (Setting& setting : settings) (setting.listed ? block.axes : block.plain).push_back(std::move(setting));
    check_keys(block);
    if (kind == BlockKind::zip) check_lengths(block);
    return block;
  }

  /// A list is an axis; for a key whose values are lists themselves, a list of lists is.
  Setting setting(BlockKind kind, const std::string& name, const toml::source_region& source,
                  const toml::node& node) const {
    Setting setting{.key = &find_key(name, at(source)), .at = source.begin};
    const auto* list = node.as_array();
    const bool key_is_list = setting.key->type.starts_with("array");
    setting.listed =
        kind != BlockKind::point && list != nullptr && (!key_is_list || (!list->empty() && list->front().is_array()));
    if (!setting.listed) {
      setting.values = {&node};
      return setting;
    }
    if (list->empty()) throw InputError(fmt::format("{}: {} has no value", at(node.source()), name));
    for (const toml::node& value : *list) setting.values.push_back(&value);
    return setting;
  }

  void check_keys(const Block& block) const {
    std::set<std::string_view> seen;
    for (const auto* settings : {&block.axes, &block.plain})
      for (const Setting& setting : *settings)
        if (!seen.insert(setting.key->name).second)
          throw InputError(
              fmt::format("{}: {} is given twice in this block", locate(name_, setting.at), setting.key->name));
  }

  void check_lengths(const Block& block) const {
    for (const Setting& axis : block.axes) {
      const Setting& first = block.axes.front();
      if (axis.values.size() != first.values.size())
        throw InputError(fmt::format(
            "{}: the lists of a [[sweep.zip]] are walked side by side and must be of one length, but {} has {} values "
            "and {} has {}",
            locate(name_, axis.at), first.key->name, first.values.size(), axis.key->name, axis.values.size()));
    }
  }

  std::string name_;
  std::filesystem::path folder_;
};

/// "system.packing_fraction = 0.8, collision.restitution = 1": what a block made of a point.
std::string describe(const Config& config, const Block& block) {
  std::string text;
  for (const auto* settings : {&block.axes, &block.plain})
    for (const Setting& setting : *settings)
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", setting.key->name,
                          setting.key->write(config, *setting.key));
  return text.empty() ? "the only one" : text;
}

class Expansion {
 public:
  Expansion(const Reader& reader, const Config& base, const std::vector<std::string>& assignments, double scale)
      : reader_(reader), base_(base), assignments_(assignments), scale_(scale) {}

  void add(const Block& block) {
    const auto points = static_cast<std::uint64_t>(block.size());
    for (std::uint64_t point = 0; point < points; ++point) {
      Config config = base_;
      for (const Setting& setting : block.plain) reader_.set(config, setting, 0);
      std::uint64_t rest = point;  // the last list of a product runs fastest
      for (auto axis = block.axes.rbegin(); axis != block.axes.rend(); ++axis) {
        reader_.set(config, *axis, block.kind == BlockKind::zip ? point : rest % axis->values.size());
        rest /= axis->values.size();
      }
      for (const std::string& assignment : assignments_) set_key(assignment, config);
      config.run.collisions *= scale_;
      try {
        check_config(config);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: the point {}: {}", block.place, describe(config, block), error.what()));
      }
      if (config.run.seed > largest_seed - *block.replicas)
        throw InputError(fmt::format("{}: run.seed = {} leaves no room for {} replicas: take a smaller one",
                                     block.place, config.run.seed, *block.replicas));
      for (std::uint64_t replica = 0; replica < *block.replicas; ++replica, ++config.run.seed) keep(config);
    }
  }

  SweepPlan plan;

 private:
  void keep(const Config& config) {
    if (seen_.insert(physics_text(config)).second)
      plan.points.push_back(config);
    else
      ++plan.repeated;
  }

  const Reader& reader_;
  const Config& base_;
  const std::vector<std::string>& assignments_;
  double scale_;
  std::unordered_set<std::string> seen_;
};

bool varies(const SweepPlan& plan, const Key& key) {
  const std::string first = key.write(plan.points.front(), key);
  return std::any_of(plan.points.begin(), plan.points.end(),
                     [&](const Config& config) { return key.write(config, key) != first; });
}

/// The points by what the axes and the seed tell of them.
std::map<std::string, std::vector<const Config*>> alike(const SweepPlan& plan) {
  std::map<std::string, std::vector<const Config*>> groups;
  for (const Config& config : plan.points) {
    std::string label = fmt::format("{}", config.run.seed);
    for (const std::string& axis : plan.axes) label += '\t' + value_text(config, axis);
    groups[label].push_back(&config);
  }
  return groups;
}

void choose_axes(SweepPlan& plan, const std::vector<Block>& blocks) {
  std::set<std::string_view> named, chosen;
  for (const Block& block : blocks) {
    for (const Setting& axis : block.axes) named.insert(axis.key->name);
    if (block.kind == BlockKind::point)
      for (const Setting& setting : block.plain) named.insert(setting.key->name);
  }
  std::vector<const Key*> others;
  for (const Key& key : config_table()) {
    if (!key.physics || key.name == "run.seed" || !varies(plan, key)) continue;
    if (named.contains(key.name))
      chosen.insert(key.name);
    else
      others.push_back(&key);
  }
  const auto list_axes = [&] {
    plan.axes.clear();
    for (const Key& key : config_table())
      if (chosen.contains(key.name)) plan.axes.emplace_back(key.name);
  };
  list_axes();
  for (const Key* key : others) {
    const auto groups = alike(plan);
    if (groups.size() == plan.points.size()) return;
    const bool tells = std::any_of(groups.begin(), groups.end(), [&](const auto& group) {
      const auto& configs = group.second;
      return std::any_of(configs.begin(), configs.end(), [&](const Config* config) {
        return key->write(*config, *key) != key->write(*configs.front(), *key);
      });
    });
    if (!tells) continue;
    chosen.insert(key->name);
    list_axes();
  }
}

}  // namespace

std::string value_text(const Config& config, std::string_view key) {
  const Key& row = find_key(std::string(key), "");
  return row.write(config, row);
}

std::string physics_text(const Config& config) {
  std::string text;
  for (const Key& key : config_table())
    if (key.physics) text += fmt::format("{} = {}\n", key.name, key.write(config, key));
  return text;
}

SweepPlan read_study_text(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                          const std::vector<std::string>& assignments, double scale) {
  if (!(scale > 0 && std::isfinite(scale)))
    throw InputError(fmt::format("--scale {} must be a positive number: it multiplies run.collisions", scale));
  toml::table file = parse_toml(text, name);
  if (!file.contains("sweep"))
    throw InputError(fmt::format(
        "{}: there is no [sweep] in it, so it is one run: start it by sandglass run, or add the table", name));
  if (!file["sweep"].is_table()) throw InputError(fmt::format("{}: sweep must be a table: write [sweep]", name));
  const toml::table sweep = std::move(*file["sweep"].as_table());  // moved, not copied: places in the file stay known
  file.erase("sweep");

  Config base;
  set_keys(file, name, folder, base);
  const Reader reader(name, folder);
  const std::vector<Block> blocks = reader.blocks(sweep);
  double points = 0;
  for (const Block& block : blocks) points += block.size() * static_cast<double>(*block.replicas);
  if (points > most_points)
    throw InputError(fmt::format("{}: these are {:g} points; a sweep has at most {:g}", name, points, most_points));
  Expansion expansion(reader, base, assignments, scale);
  for (const Block& block : blocks) expansion.add(block);
  choose_axes(expansion.plan, blocks);
  return std::move(expansion.plan);
}

SweepPlan read_study(const std::filesystem::path& file, const std::vector<std::string>& assignments, double scale) {
  return read_study_text(read_config_file(file), file.string(), std::filesystem::absolute(file).parent_path(),
                         assignments, scale);
}

}  // namespace sandglass
