#include "sandglass/report/page.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sandglass/report/page_files.h"

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
  }
  return "solid";
}

Json json_of(const Axis& axis) { return {{"label", axis.label}, {"unit", axis.unit}, {"log", axis.log}}; }

Json json_of(const Curve& curve) {
  return {{"name", curve.name}, {"role", name_of(curve.role)}, {"line", name_of(curve.line)},         {"x", curve.x},
          {"y", curve.y},       {"error", curve.error},        {"alternative_x", curve.alternative_x}};
}

Json json_of(const Figure& figure) {
  Json json{{"id", figure.id},           {"title", figure.title},  {"caption", figure.caption},
            {"missing", figure.missing}, {"x", json_of(figure.x)}, {"alternative_x", json_of(figure.alternative_x)},
            {"y", json_of(figure.y)},    {"y_range", nullptr},     {"curves", Json::array()}};
  if (figure.y_range) json["y_range"] = *figure.y_range;
  for (const Curve& curve : figure.curves) json["curves"].push_back(json_of(curve));
  return json;
}

/// Positions to 10^-3 R_s, finer than any screen shows and half as long.
Json rounded(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(std::round(value * 1000) / 1000);
  return json;
}

Json json_of(const Packing& packing) {
  return {
      {"box_length", packing.box_length}, {"left", packing.left}, {"bottom", packing.bottom}, {"side", packing.side},
      {"radius", packing.radius},         {"id", packing.id},     {"x", rounded(packing.x)},  {"y", rounded(packing.y)},
      {"species", packing.species}};
}

Json json_of(const Table& table) { return {{"columns", table.columns}, {"rows", table.rows}}; }

Json json_of(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Json json = Json::array();
  for (const auto& [name, value] : pairs) json.push_back({name, value});
  return json;
}

Json json_of(const Page& page) {
  Json json{{"title", page.title},
            {"subtitle", page.subtitle},
            {"summary", page.summary},
            {"highlights", json_of(page.highlights)},
            {"figures", Json::array()},
            {"packing", nullptr},
            {"packing_missing", page.packing_missing},
            {"results", json_of(page.results)},
            {"parameters", json_of(page.parameters)},
            {"decisions", page.decisions},
            {"warnings", page.warnings},
            {"config", page.config},
            {"commands", page.commands},
            {"provenance", json_of(page.provenance)}};
  for (const Figure& figure : page.figures) json["figures"].push_back(json_of(figure));
  if (page.packing) json["packing"] = json_of(*page.packing);
  return json;
}

}  // namespace

std::string safe_in_script(const std::string& json) {
  std::string safe;
  safe.reserve(json.size() + 64);
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string_view rest = std::string_view(json).substr(i, 3);
    if (json[i] == '<') {
      safe += "\\u003c";
    } else if (json[i] == '>') {
      safe += "\\u003e";
    } else if (json[i] == '&') {
      safe += "\\u0026";
    } else if (rest == "\xe2\x80\xa8" || rest == "\xe2\x80\xa9") {
      safe += rest == "\xe2\x80\xa8" ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      safe += json[i];
    }
  }
  return safe;
}

std::string page_html(const Page& page) {
  // Bytes that are no UTF-8 (a file name may hold any) are replaced, not refused.
  const std::string data = json_of(page).dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::pair<std::string_view, std::string> parts[] = {
      {"{{library-style}}", std::string(page_files::library_style)},
      {"{{style}}", std::string(page_files::style)},
      {"{{data}}", safe_in_script(data)},
      {"{{library-licence}}", std::string(page_files::library_licence)},
      {"{{library}}", std::string(page_files::library)},
      {"{{plot}}", std::string(page_files::plot)},
      {"{{script}}", std::string(page_files::script)}};
  std::string html;
  std::string_view rest = page_files::html;
  for (const auto& [mark, text] : parts) {  // in the order of the template, so that no part is searched for marks
    const std::size_t at = rest.find(mark);
    html.append(rest.substr(0, at)).append(text);
    rest.remove_prefix(at + mark.size());
  }
  return html.append(rest);
}

}  // namespace sandglass
