#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "sandglass/study/sweep_plan.h"

namespace sandglass {
namespace {

constexpr std::size_t longest_name = 200;  // file systems end at 255, and files within have names too

/// The customary symbol of a key, or its own name.
std::string symbol(std::string_view key) {
  if (key == "system.particles") return "N";
  if (key == "system.packing_fraction") return "eta";
  if (key == "collision.restitution") return "eps";
  return std::string(key.substr(key.find('.') + 1));
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Digits after the point; none for a number that has too many to be written out.
std::optional<int> decimals(const std::string& text) {
  const auto value = number(text);
  if (!value || *value < 0 || *value >= 1e15) return std::nullopt;
  if (*value == std::floor(*value)) return 0;
  const auto point = text.find('.');
  if (point == std::string::npos || text.find('e') != std::string::npos) return std::nullopt;
  return static_cast<int>(text.size() - point - 1);
}

bool all_digits(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Numbers written with the same digits before and after the point, so that they sort; anything else as it is.
void align(std::vector<std::string>& texts, int least_decimals) {
  std::size_t width = 0;
  if (std::all_of(texts.begin(), texts.end(), all_digits)) {
    for (const std::string& text : texts) width = std::max(width, text.size());
    for (std::string& text : texts) text.insert(0, width - text.size(), '0');
    return;
  }
  int digits = least_decimals;
  for (const std::string& text : texts) {
    const auto own = decimals(text);
    if (!own) return;
    digits = std::max(digits, *own);
  }
  for (std::string& text : texts) {
    text = fmt::format("{:.{}f}", *number(text), digits);
    width = std::max(width, text.size());
  }
  for (std::string& text : texts) text.insert(0, width - text.size(), '0');
}

/// Letters, digits and . = - only; quotes and a plus sign go, other runs become one hyphen.
std::string safe(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '=' || c == '-')
      out += c;
    else if (c != '"' && c != '+' && c != '[' && c != ']' && !out.empty() && out.back() != '-')
      out += '-';
  }
  return out;
}

}  // namespace

std::vector<std::string> point_names(const SweepPlan& plan) {
  std::vector<std::string> keys = plan.axes;
  keys.emplace_back("run.seed");
  std::vector<std::string> names(plan.points.size());
  for (const std::string& key : keys) {
    std::vector<std::string> texts;
    for (const Config& config : plan.points) texts.push_back(value_text(config, key));
    const std::string name = symbol(key);
    align(texts, name == "eta" || name == "eps" ? 2 : 0);
    for (std::size_t i = 0; i < names.size(); ++i)
      names[i] += fmt::format("{}{}={}", names[i].empty() ? "" : "_", name, safe(texts[i]));
  }
  for (std::string& name : names)
    if (name.size() > longest_name) name.erase(longest_name);
  return names;
}

}  // namespace sandglass
