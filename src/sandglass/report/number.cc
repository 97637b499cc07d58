#include "sandglass/report/number.h"

#include <fmt/format.h>

#include <cmath>

namespace sandglass {
namespace {

std::string superscript(int number) {
  constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
  return text;
}

}  // namespace

std::string short_number(double value) {
  if (!std::isfinite(value)) return "unknown";
  const double size = std::abs(value);
  if (size == 0 || (size >= 1e-3 && size < 1000)) return fmt::format("{:.4g}", value);
  if (size >= 1000 && size < 1e6)
    return fmt::format("{}{}", value < 0 ? "-" : "", grouped(static_cast<unsigned long long>(std::llround(size))));
  const std::string text = fmt::format("{:.3e}", value);
  const std::size_t e = text.find('e');
  return text.substr(0, e) + "·10" + superscript(std::stoi(text.substr(e + 1)));
}

std::string with_error(double value, double error) {
  if (!std::isfinite(value)) return "unknown";
  if (!std::isfinite(error) || error <= 0) return short_number(value);
  int exponent = static_cast<int>(std::floor(std::log10(error)));
  if (std::floor(error * std::pow(10.0, -exponent)) < 2) --exponent;  // two digits for an error that begins with 1
  if (exponent > 0 || exponent < -9) {
    const double unit = std::pow(10.0, exponent);
    auto rounded = [unit](double number) { return short_number(std::round(number / unit) * unit); };
    return fmt::format("{} ± {}", rounded(value), rounded(error));
  }
  const double digits = std::round(error * std::pow(10.0, -exponent));
  return fmt::format("{:.{}f}({:.0f})", value, -exponent, digits);
}

std::string grouped(unsigned long long count) {
  const std::string plain = std::to_string(count);
  std::string text;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (i > 0 && (plain.size() - i) % 3 == 0) text += "\u2009";
    text += plain[i];
  }
  return text;
}

}  // namespace sandglass
