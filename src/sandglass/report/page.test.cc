#include "sandglass/report/page.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <nlohmann/json.hpp>

#include "sandglass/report/synthetic_run.test.h"

namespace sandglass {
namespace {

nlohmann::json data_of(const std::string& html) {
  const std::string open = "<script id=\"data\" type=\"application/json\">";
  const std::size_t begin = html.find(open) + open.size();
  REQUIRE(begin > open.size());
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

constexpr const char* hostile =
    "</script><script>alert(1)</script><!-- <img src=x onerror=alert(1)> \" \\ ' & \xe2\x80\xa8 {{script}}";

}  // namespace

TEST_CASE("hostile text stays text") {
  const Page plain = run_page(synthetic_run(100));
  Page page = plain;
  page.title = page.subtitle = page.packing_missing = page.config = hostile;
  page.summary = page.decisions = page.warnings = page.commands = {hostile};
  page.highlights = page.provenance = {{hostile, hostile}};
  page.results = {{hostile}, {{hostile}}};
  for (Figure& figure : page.figures) {
    figure.id = figure.title = figure.caption = figure.missing = figure.x.label = figure.y.unit = hostile;
    for (Curve& curve : figure.curves) curve.name = hostile;
  }
  const std::string html = page_html(page);
  const std::string reference = page_html(plain);
  for (const char* mark : {"<script", "</script", "<!--", "<img", "{{"}) {
    if (std::string(mark) != "{{") CHECK(occurrences(html, mark) == occurrences(reference, mark));
  }
  const auto data = data_of(html);
  CHECK(data["title"] == hostile);
  CHECK(data["results"]["rows"][0][0] == hostile);
  CHECK(data["figures"][0]["curves"][0]["name"] == hostile);
}

TEST_CASE("bytes that are no UTF-8 do not stop the page") {
  Page page;
  page.title = "a\xff\xc3(";
  CHECK(data_of(page_html(page))["title"].get<std::string>().starts_with("a"));
}

TEST_CASE("no mark of the template is left, whatever the parts hold") {
  const std::string html = page_html(run_page(synthetic_run(100)));
  for (const char* mark : {"{{library", "{{style", "{{data", "{{plot", "{{script"})
    CHECK(html.find(mark) == std::string::npos);
  CHECK(html.find("uPlot") != std::string::npos);
  CHECK(html.find("Permission is hereby granted") != std::string::npos);
}

TEST_CASE("figure data reach the page with all their bits") {
  const Page page = run_page(synthetic_run(100));
  const auto data = data_of(page_html(page));
  REQUIRE(data["figures"].size() == page.figures.size());
  for (std::size_t f = 0; f < page.figures.size(); ++f) {
    for (std::size_t c = 0; c < page.figures[f].curves.size(); ++c) {
      const auto& json = data["figures"][f]["curves"][c];
      CHECK(json["x"].get<std::vector<double>>() == page.figures[f].curves[c].x);
      CHECK(json["y"].get<std::vector<double>>() == page.figures[f].curves[c].y);
    }
  }
  CHECK(data["packing"]["x"].size() == 100);
}

TEST_CASE("an error that is unknown is null") {
  Page page = run_page(synthetic_run(100));
  page.figures.front().curves.front().error.front() = Summary::unknown;
  CHECK(data_of(page_html(page))["figures"][0]["curves"][0]["error"][0].is_null());
}

TEST_CASE("any text survives the way into a script, which it cannot end") {
  rc::check([] {
    const auto text =
        *rc::gen::container<std::string>(rc::gen::elementOf(std::string("</script>!-&\"\\ \xe2\x80\xa8\xa9")));
    const std::string json = nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const std::string safe = safe_in_script(json);
    RC_ASSERT(safe.find('<') == std::string::npos);
    RC_ASSERT(safe.find('&') == std::string::npos);
    RC_ASSERT(safe.find("\xe2\x80\xa8") == std::string::npos);
    RC_ASSERT(nlohmann::json::parse(safe) == nlohmann::json::parse(json));
  });
}

}  // namespace sandglass
