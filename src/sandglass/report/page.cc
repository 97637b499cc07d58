#include "sandglass/report/page.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "sandglass/report/figure_json.h"
#include "sandglass/report/page_files.h"

namespace sandglass {
namespace {

using Json = nlohmann::ordered_json;

/// Positions to 10^-3 R_s, finer than any screen shows and half as long.
Json rounded(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(std::round(value * 1000) / 1000);
  return json;
}

Json json_of(const Packing& packing) {
  std::vector<double> real, imaginary;
  for (const std::complex<double>& psi : packing.psi) real.push_back(psi.real()), imaginary.push_back(psi.imag());
  return {{"box_length", packing.box_length}, {"left", packing.left},
          {"bottom", packing.bottom},         {"side", packing.side},
          {"radius", packing.radius},         {"id", packing.id},
          {"x", rounded(packing.x)},          {"y", rounded(packing.y)},
          {"species", packing.species},       {"psi", {rounded(real), rounded(imaginary)}}};
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
  for (const Figure& figure : page.figures) json["figures"].push_back(figure_json(figure));
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

std::string html_of(std::string_view content, const Json& data, std::string_view script) {
  // Bytes that are no UTF-8 (a file name may hold any) are replaced, not refused.
  const std::string text = data.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::pair<std::string_view, std::string> parts[] = {
      {"{{library-style}}", std::string(page_files::library_style)},
      {"{{style}}", std::string(page_files::style)},
      {"{{content}}", std::string(content)},
      {"{{data}}", safe_in_script(text)},
      {"{{library-licence}}", std::string(page_files::library_licence)},
      {"{{library}}", std::string(page_files::library)},
      {"{{plot}}", std::string(page_files::plot)},
      {"{{figure}}", std::string(page_files::figure)},
      {"{{frame-script}}", std::string(page_files::frame_script)},
      {"{{script}}", std::string(script)}};
  std::string_view frame = page_files::frame;
  std::string html;
  for (const auto& [mark, part] : parts) {  // in the order of the frame, so that no part is searched for marks
    const std::size_t at = frame.find(mark);
    html.append(frame.substr(0, at)).append(part);
    frame.remove_prefix(at + mark.size());
  }
  return html.append(frame);
}

std::string page_html(const Page& page) {
  return html_of(page_files::run_content, json_of(page), page_files::run_script);
}

}  // namespace sandglass
