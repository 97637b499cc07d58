#include "sandglass/io/csv.h"

#include <fmt/format.h>

#include <cmath>

namespace sandglass {

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == text.npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  cell += '"';
  return cell;
}

std::string csv_cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }

}  // namespace sandglass
