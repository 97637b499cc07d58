#include "sandglass/cmd/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sandglass {

std::string duration_text(double seconds) {
  constexpr double longest = 1e15;  // beyond any clock
  if (!(std::fabs(seconds) < longest)) return "an unknown time";
  const auto whole = static_cast<long>(std::fmax(seconds, 0) + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  if (whole < 48 * 3600) return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{} days {} h", whole / 86400, whole % 86400 / 3600);
}

std::string shell_word(std::string_view word) {
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+%@";
  if (!word.empty() && word.find_first_not_of(harmless) == word.npos) return std::string(word);
  const auto acts = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
  const bool escape = std::any_of(word.begin(), word.end(), acts);
  std::string quoted = escape ? "$'" : "'";
  for (const char c : word) {
    if (acts(c))
      quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    else if (escape && (c == '\'' || c == '\\'))
      quoted.append("\\").append(1, c);
    else if (c == '\'')
      quoted += R"('\'')";
    else
      quoted += c;
  }
  return quoted + "'";
}

}  // namespace sandglass
