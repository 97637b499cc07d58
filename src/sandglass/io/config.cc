#include "sandglass/io/config.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/config_table.h"

namespace sandglass {
namespace {

/// Levenshtein's edit distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row[b.size()];
}

/// The known key that an unknown one may have meant: near as a whole, or right but for its section.
std::string suggestion(std::string_view unknown) {
  const std::string_view leaf = unknown.substr(unknown.rfind('.') + 1);
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const Key& candidate : config_table()) {
    const std::size_t distance =
        std::min(edit_distance(unknown, candidate.name), edit_distance(leaf, candidate.leaf()) + 1);
    if (distance < least) least = distance, best = candidate.name;
  }
  const std::size_t tolerated = std::max<std::size_t>(2, leaf.size() / 3) + 1;
  if (least <= tolerated) return fmt::format("did you mean {}?", best);
  return "see docs/configuration.md for all keys";
}

void check_section(const std::string& section, const std::string& place) {
  if (section == "sweep")
    throw InputError(
        fmt::format("{}: [sweep] makes this a study of many runs: make their folders by sandglass sweep init", place));
  std::string_view best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const Key& key : config_table()) {
    const std::size_t distance = edit_distance(section, key.section());
    if (distance == 0) return;
    if (distance < least) least = distance, best = key.section();
  }
  throw InputError(fmt::format("{}: unknown section [{}]: did you mean [{}]?", place, section, best));
}

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == text.npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// Strings come from the command line too; a file that holds anything but UTF-8 could not be read again.
void check_text(const Config& config) {
  try {
    (void)toml::parse("value = " + toml_quote(config.prepare.file));
  } catch (const toml::parse_error&) {
    throw InputError("prepare.file is not valid UTF-8: rename the file");
  }
}

}  // namespace

std::string read_config_file(const std::filesystem::path& file) {
  constexpr std::size_t longest = 1 << 20;  // no configuration is a megabyte long
  return read_whole(file, longest);
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  // A key a.a.a... makes as many tables, one in the other, as it has dots, and the library frees them by recursion.
  constexpr std::ptrdiff_t most_dots = 4096;
  if (std::count(text.begin(), text.end(), '.') > most_dots)
    throw InputError(fmt::format("{}: more than {} dots: this is not the file meant", name, most_dots));
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}: this is not TOML: {}", locate(name, error.source().begin), error.description()));
  }
}

const Key& find_key(const std::string& name, const std::string& place) {
  const auto found =
      std::find_if(config_table().begin(), config_table().end(), [&](const Key& key) { return key.name == name; });
  if (found != config_table().end()) return *found;
  throw InputError(fmt::format("{}: unknown key {}: {}", place, name, suggestion(name)));
}

std::string locate(const std::string& name, const toml::source_position& at) {
  return fmt::format("{}:{}:{}", name, at.line, at.column);
}

void set_keys(const toml::table& file, const std::string& name, const std::filesystem::path& folder, Config& config) {
  for (const auto& [section, content] : file) {
    const std::string section_name{section.str()};
    const std::string place = locate(name, section.source().begin);
    const auto* keys = content.as_table();
    if (keys == nullptr) {
      throw InputError(fmt::format("{}: key {} is in no section: {}", place, section_name, suggestion(section_name)));
    }
    check_section(section_name, place);
    for (const auto& [leaf, node] : *keys) {
      const Key& key = find_key(section_name + '.' + std::string(leaf.str()), locate(name, leaf.source().begin));
      key.read(config, key, {node, locate(name, node.source().begin), "", folder});
    }
  }
}

void set_key(const std::string& assignment, Config& config) {
  const std::string place = "--set " + assignment;
  const auto equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw InputError(fmt::format("{}: no value; write --set key=value, for example --set run.seed=7", place));
  }
  const Key& key = find_key(trimmed(std::string_view(assignment).substr(0, equals)), place);
  const std::string raw = trimmed(std::string_view(assignment).substr(equals + 1));
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + raw);
  } catch (const toml::parse_error&) {
  }
  if (parsed.size() != 1) parsed = toml::table{{"value", raw}};
  key.read(config, key, {*parsed.get("value"), place, raw, std::filesystem::current_path()});
  check_text(config);
}

Config read_config_text(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                        const std::vector<std::string>& assignments) {
  Config config;
  set_keys(parse_toml(text, name), name, folder, config);
  for (const std::string& assignment : assignments) set_key(assignment, config);
  check_config(config);
  return config;
}

Config read_config(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  if (file.empty()) return read_config_text("", "", "", assignments);
  return read_config_text(read_config_file(file), file.string(), std::filesystem::absolute(file).parent_path(),
                          assignments);
}

std::string config_to_toml(const Config& config) {
  std::string out = "# All keys of this run, defaults included.\n";
  std::string_view section;
  for (const Key& key : config_table()) {
    if (key.section() != section) out += fmt::format("\n[{}]\n", section = key.section());
    std::string allowed = key.allowed();
    if (!key.unit.empty()) allowed += fmt::format("{}in {}", allowed.empty() ? "" : ", ", key.unit);
    out += fmt::format("# {}{}\n", key.description, allowed.empty() ? "" : " (" + allowed + ")");
    out += fmt::format("{} = {}\n", key.leaf(), key.write(config, key));
  }
  return out;
}

std::string config_reference() {
  std::string out =
      "| key | type | default | range | unit | meaning | may differ on --resume |\n|---|---|---|---|---|---|---|\n";
  const Config defaults;
  for (const Key& key : config_table()) {
    out += fmt::format("| `{}` | {} | `{}` | {} | {} | {} | {} |\n", key.name, key.type, key.write(defaults, key),
                       key.allowed(), key.unit, key.description, key.physics ? "no" : "yes");
  }
  return out;
}

std::vector<std::string> differing_keys(const Config& a, const Config& b) {
  std::vector<std::string> names;
  for (const Key& key : config_table()) {
    if (key.physics && key.write(a, key) != key.write(b, key)) names.emplace_back(key.name);
  }
  return names;
}

}  // namespace sandglass
