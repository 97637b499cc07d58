// The one table of all keys: it drives reading, writing, documentation and comparison of configurations.
#pragma once

#include <toml++/impl/forward_declarations.h>

#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sandglass/io/config.h"

namespace sandglass {

struct Range {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = -infinity, high = infinity;
  bool open = false;  ///< `low` itself is not allowed
};

/// A value as the user gave it, with what a message needs to point at it.
struct Given {
  const toml::node& node;
  std::string place;             ///< "file:line:column" or "--set key=value"
  std::string raw;               ///< the text after '=' on the command line
  std::filesystem::path folder;  ///< what a relative path is relative to
};

/// One key: a row of the table.
struct Key {
  std::string_view name{}, unit{}, description{};
  Range range{};
  std::vector<std::string_view> words{};  ///< names of an enumeration, in the order of its values
  bool physics = true;                    ///< part of what the run is: must not differ when it is resumed

  // Filled in by the table from the member that the row stands for.
  std::string_view type{};
  void (*read)(Config&, const Key&, const Given&) = nullptr;  ///< throws InputError
  std::string (*write)(const Config&, const Key&) = nullptr;  ///< TOML that reads back to the same bits

  [[nodiscard]] std::string_view section() const { return name.substr(0, name.find('.')); }
  [[nodiscard]] std::string_view leaf() const { return name.substr(name.find('.') + 1); }
  [[nodiscard]] std::string allowed() const;  ///< the range or the words, for people; empty if anything goes
};

/// All keys, section by section.
const std::vector<Key>& config_table();

/// The text of a configuration, which is no longer than a megabyte. Throws InputError.
std::string read_config_file(const std::filesystem::path& file);

/// Parses TOML; `name` stands for the file in the InputError that it throws.
toml::table parse_toml(std::string_view text, const std::string& name);

/// The row of a key. Throws InputError that begins with `place` and suggests the nearest known one.
const Key& find_key(const std::string& name, const std::string& place);

/// "file:line:column".
std::string locate(const std::string& file, const toml::source_position& at);

/// Sets the keys of a parsed file, section by section. `name` and `folder` as in read_config_text. Throws InputError.
void set_keys(const toml::table& file, const std::string& name, const std::filesystem::path& folder, Config& config);

/// Sets one key by "key=value" of the command line: a TOML value, or a string where it is none. Throws InputError.
void set_key(const std::string& assignment, Config& config);

/// A TOML basic string: quotes, backslashes and control characters escaped.
std::string toml_quote(std::string_view text);

}  // namespace sandglass
