// The page as data, and the HTML file made from it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sandglass/report/figure_data.h"
#include "sandglass/report/packing.h"

namespace sandglass {

struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

struct Page {
  std::string title, subtitle;
  std::vector<std::string> summary;                             ///< paragraphs in plain language
  std::vector<std::pair<std::string, std::string>> highlights;  ///< a quantity and its value, the few that matter most
  std::vector<Figure> figures;
  std::optional<Packing> packing;
  std::string packing_missing;  ///< why there is no picture of the packing
  Table results, parameters;
  std::vector<std::string> decisions, warnings;
  std::string config;                                           ///< config.toml as it was run
  std::vector<std::string> commands;                            ///< that make the run again
  std::vector<std::pair<std::string, std::string>> provenance;  ///< version, seed, state hash ...
};

/// One HTML file that needs no other: style, plot library, script and data are in it. Every text of `page` reaches the
/// reader as text, whatever characters it holds.
std::string page_html(const Page& page);

/// The same for any page: `content`, what stands between its head and its foot, and `script`, which fills it from
/// `data`. All pages begin with `data`'s title, subtitle, summary and highlights.
std::string html_of(std::string_view content, const nlohmann::ordered_json& data, std::string_view script);

/// JSON that may stand inside <script>: <, >, & and the two line separators of Unicode are written as \uXXXX, which
/// inside JSON strings is the same text and can neither end the script nor open a comment.
std::string safe_in_script(const std::string& json);

}  // namespace sandglass
