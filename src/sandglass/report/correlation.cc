#include "sandglass/report/correlation.h"

#include <fmt/format.h>

#include <cmath>

#include "sandglass/study/results.h"

namespace sandglass {

std::optional<Correlation> correlation(const Results& results, std::string_view species, std::string_view quantity,
                                       std::string& missing, std::size_t rows) {
  const std::string group = fmt::format("/dynamics/{}/{}", species, quantity);
  auto read = [&](const char* name) { return numbers_of(results, group + "/" + name); };
  Correlation c{read("time"), read("collisions"), read("value"), read("error")};
  if (c.time.empty() || c.value.empty()) {
    missing += fmt::format("The results hold no {} (or only a part of it). ", group);
    return std::nullopt;
  }
  const std::size_t expected = c.lags() * rows;
  if (c.value.size() != expected) {
    missing += fmt::format("{} has {} values where {} were expected. ", group, c.value.size(), expected);
    return std::nullopt;
  }
  if (c.error.size() != expected) c.error.clear();
  if (c.collisions.size() != c.lags()) c.collisions.clear();
  return c;
}

Curve curve_of(const Correlation& c, std::string name, Role role, std::size_t row, double scale) {
  Curve curve{.name = std::move(name), .role = role};
  for (std::size_t lag = 0; lag < c.lags(); ++lag) {
    const std::size_t i = row * c.lags() + lag;
    if (!std::isfinite(c.value[i])) continue;
    curve.x.push_back(c.time[lag]);
    curve.y.push_back(c.value[i] / scale);
    if (!c.error.empty()) curve.error.push_back(c.error[i] / std::abs(scale));
    if (!c.collisions.empty()) curve.alternative_x.push_back(c.collisions[lag]);
  }
  return curve;
}

}  // namespace sandglass
