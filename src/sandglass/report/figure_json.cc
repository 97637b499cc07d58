#include "sandglass/report/figure_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sandglass/io/csv.h"

namespace sandglass {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view name_of(Role role) {
  switch (role) {
    case Role::all:
      return "all";
    case Role::small:
      return "small";
    case Role::big:
      return "big";
    case Role::fit:
      return "fit";
    case Role::guide:
      return "guide";
    case Role::family:
      return "family";
  }
  return "all";
}

constexpr std::string_view name_of(Line line) {
  switch (line) {
    case Line::solid:
      return "solid";
    case Line::dashed:
      return "dashed";
    case Line::dotted:
      return "dotted";
    case Line::points:
      return "points";
  }
  return "solid";
}

Json json_of(const Axis& axis) { return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}}; }

Json json_of(const Curve& curve) {
  return {{"name", curve.name},
          {"role", name_of(curve.role)},
          {"line", name_of(curve.line)},
          {"x", curve.x},
          {"y", curve.y},
          {"error", curve.error},
          {"alternative_x", curve.alternative_x},
          {"level", curve.level}};
}

Json json_of(const HeatMap& map) {
  return {{"x0", map.x0},           {"dx", map.dx},     {"y0", map.y0},         {"dy", map.dy},
          {"columns", map.columns}, {"rows", map.rows}, {"values", map.values}, {"scale", json_of(map.scale)}};
}

/// Number `i` of a column that may be absent.
std::string cell(const std::vector<double>& values, std::size_t i) {
  return i < values.size() ? csv_cell(values[i]) : std::string();
}

std::string comment(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return "# " + text + '\n';
}

std::string axis_text(const Axis& axis) {
  return axis.unit.empty() ? axis.label : fmt::format("{} [{}]", axis.label, axis.unit);
}

void append_header(const Figure& figure, const std::string& part, std::string& csv) {
  csv += comment(
      fmt::format("part {}: {}; x = {}; y = {}{}{}", part, figure.title, axis_text(figure.x), axis_text(figure.y),
                  figure.alternative_x.label.empty() ? "" : "; second_x = " + axis_text(figure.alternative_x),
                  figure.family.label.empty() ? "" : "; level = " + axis_text(figure.family)));
  if (!figure.missing.empty()) csv += comment("  missing: " + figure.missing);
}

void append_rows(const Figure& figure, const std::string& part, std::string& csv) {
  for (const Curve& curve : figure.curves) {
    const std::string level = curve.role == Role::family ? fmt::format("{}", curve.level) : "";
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      csv += fmt::format("{},{},{},{},{},{},{},\n", part, csv_cell(curve.name), level, cell(curve.x, i),
                         cell(curve.alternative_x, i), cell(curve.y, i), cell(curve.error, i));
  }
  if (!figure.map) return;
  const HeatMap& map = *figure.map;
  for (std::size_t i = 0; i < map.values.size(); ++i)
    csv += fmt::format("{},{},,{},,{},,{}\n", part, csv_cell(map.scale.label),
                       map.x0 + static_cast<double>(i % map.columns) * map.dx,
                       map.y0 + static_cast<double>(i / map.columns) * map.dy, cell(map.values, i));
}

/// The figure and its parts with their names in the CSV.
template <class Visit>
void visit_parts(const Figure& figure, Visit&& visit) {
  visit(figure, figure.id);
  for (const Figure& panel : figure.panels) visit(panel, panel.id);
  for (const Figure& inset : figure.insets) visit(inset, inset.id);
}

}  // namespace

Json figure_json(const Figure& figure) {
  Json json{{"id", figure.id},
            {"title", figure.title},
            {"caption", figure.caption},
            {"missing", figure.missing},
            {"x", json_of(figure.x)},
            {"alternative_x", json_of(figure.alternative_x)},
            {"y", json_of(figure.y)},
            {"family", json_of(figure.family)},
            {"y_range", nullptr},
            {"curves", Json::array()},
            {"map", nullptr},
            {"panels", Json::array()},
            {"insets", Json::array()},
            {"statement", figure.statement},
            {"verdict", figure.checks.empty() ? "" : outcome_text(verdict(figure))},
            {"checks", Json::array()}};
  if (figure.y_range) json["y_range"] = *figure.y_range;
  if (figure.map) json["map"] = json_of(*figure.map);
  for (const Curve& curve : figure.curves) json["curves"].push_back(json_of(curve));
  for (const Figure& panel : figure.panels) json["panels"].push_back(figure_json(panel));
  for (const Figure& inset : figure.insets) json["insets"].push_back(figure_json(inset));
  for (const Check& check : figure.checks)
    json["checks"].push_back(
        {{"claim", check.claim}, {"outcome", outcome_text(check.outcome)}, {"finding", check.finding}});
  return json;
}

std::string figure_csv(const Figure& figure) {
  std::string csv = comment(figure.title) + comment(figure.caption);
  visit_parts(figure, [&](const Figure& part, const std::string& name) { append_header(part, name, csv); });
  csv += "# error is the standard error of y; value belongs to maps\npart,curve,level,x,second_x,y,error,value\n";
  visit_parts(figure, [&](const Figure& part, const std::string& name) { append_rows(part, name, csv); });
  return csv;
}

Check::Outcome verdict(const Figure& figure) {
  Check::Outcome outcome = Check::Outcome::not_enough_data;
  for (const Check& check : figure.checks) {
    if (check.outcome == Check::Outcome::differs) return check.outcome;
    if (check.outcome == Check::Outcome::agrees) outcome = check.outcome;
  }
  return outcome;
}

std::string outcome_text(Check::Outcome outcome) {
  switch (outcome) {
    case Check::Outcome::agrees:
      return "agrees";
    case Check::Outcome::differs:
      return "differs";
    case Check::Outcome::not_enough_data:
      return "not enough data";
  }
  return "not enough data";
}

}  // namespace sandglass
