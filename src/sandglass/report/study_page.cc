#include "sandglass/report/study_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sandglass/core/version.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/report/figure_json.h"
#include "sandglass/report/number.h"
#include "sandglass/report/page.h"
#include "sandglass/report/page_files.h"
#include "sandglass/report/paper_figures.h"

namespace sandglass {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// What the plane of state points can be coloured by.
struct PlaneQuantity {
  const char *key, *label;
  bool log;
};
constexpr PlaneQuantity plane_quantities[] = {{"msd_unit_time/small", "t(MSD = 1)", true},
                                              {"collision_rate", "collision rate ω", true},
                                              {"compressibility_factor", "pressure Z", true},
                                              {"temperature/all", "temperature T", false},
                                              {"msd_exponent/small/value", "MSD exponent", false}};

std::string counted(std::size_t count, const std::string& thing) {
  return fmt::format("{} {}{}", grouped(count), thing, count == 1 ? "" : "s");
}

std::size_t run_count(const Study& study) {
  std::size_t runs = 0;
  for (const StatePoint& point : study.points) runs += point.replicas.size();
  return runs;
}

std::vector<std::string> summary_of(const Study& study, const std::vector<Figure>& figures) {
  const auto of_paper = [](const Figure& f) { return !f.statement.empty(); };
  const auto with = [&](Check::Outcome outcome) {
    return std::count_if(figures.begin(), figures.end(),
                         [&](const Figure& f) { return of_paper(f) && verdict(f) == outcome; });
  };
  std::size_t unsteady = 0;
  double length = 0;
  for (const StatePoint& point : study.points) {
    length += point.length();
    for (const Replica& replica : point.replicas) unsteady += replica.summary.stationary ? 0 : 1;
  }
  std::vector<std::string> text{
      fmt::format("{} at {} were merged, {} collisions per disk in all.", counted(run_count(study), "finished run"),
                  counted(study.points.size(), "state point"), short_number(length)),
      fmt::format(
          "Of the paper's {} figures {} agree with what it reports, {} differ in at least one point, and for {} "
          "there are not enough data.",
          std::count_if(figures.begin(), figures.end(), of_paper), with(Check::Outcome::agrees),
          with(Check::Outcome::differs), with(Check::Outcome::not_enough_data))};
  if (unsteady > 0)
    text.push_back(
        fmt::format("{} did not pass the test of stationarity: what is averaged there may change with the "
                    "age of the system.",
                    counted(unsteady, "run")));
  if (!study.absent.empty())
    text.push_back(
        fmt::format("Without data: {} found or expected, listed at the end.", counted(study.absent.size(), "run")));
  return text;
}

Json points_json(const Study& study, const fs::path& folder) {
  std::error_code error;
  const fs::path from = fs::weakly_canonical(folder, error), base = fs::weakly_canonical(study.folder, error);
  Json points = Json::array();
  for (const StatePoint& point : study.points) {
    Json json{{"name", point.name},
              {"packing_fraction", point.packing_fraction()},
              {"restitution", point.restitution()},
              {"numbers", Json::object()},
              {"texts", Json::object()},
              {"replicas", Json::array()}};
    for (const PlaneQuantity& q : plane_quantities) {
      const Measured number = point.number(q.key);
      json["numbers"][q.key] = number.value;
      json["texts"][q.key] = with_error(number.value, number.error);
    }
    for (const Replica& replica : point.replicas)
      json["replicas"].push_back(
          {{"seed", replica.summary.seed},
           {"stationary", replica.summary.stationary},
           {"href", url_of((base / replica.path / "report.html").lexically_normal().lexically_relative(from))}});
    points.push_back(std::move(json));
  }
  return points;
}

}  // namespace

std::string url_of(const fs::path& path) {
  std::string url;
  for (const unsigned char c : path.generic_string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(static_cast<char>(c)) != std::string_view::npos;
    url += plain ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  }
  return url;
}

std::string study_html(const Study& study, const std::vector<Figure>& figures, const fs::path& folder) {
  const auto seen = [&](const std::vector<Figure>& list) {
    Json json = Json::array();
    for (const Figure& figure : list) json.push_back(figure_json(figure));
    return json;
  };
  std::vector<double> densities, restitutions;
  for (const StatePoint& point : study.points) {
    densities.push_back(point.packing_fraction());
    restitutions.push_back(point.restitution());
  }
  const auto range = [](std::vector<double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *low == *high ? fmt::format("{:g}", *low) : fmt::format("{:g} to {:g}", *low, *high);
  };
  Json json{
      {"title", "Driven granular fluid: a study"},
      {"subtitle", fmt::format("{} · packing fraction {} · restitution {}", counted(study.points.size(), "state point"),
                               range(densities), range(restitutions))},
      {"summary", summary_of(study, figures)},
      {"highlights", Json::array({{"state points", grouped(study.points.size())},
                                  {"finished runs", grouped(run_count(study))},
                                  {"runs without data", grouped(study.absent.size())},
                                  {"version", std::string(version)}})},
      {"quantities", Json::array()},
      {"points", points_json(study, folder)},
      {"absent", Json::array()},
      {"overview", seen(overview_figures(study))},
      {"figures", seen(figures)}};
  for (const PlaneQuantity& q : plane_quantities)
    json["quantities"].push_back({{"key", q.key}, {"label", q.label}, {"log", q.log}});
  for (const AbsentRun& run : study.absent) json["absent"].push_back({run.path, run.why});
  return html_of(page_files::study_content, json, page_files::study_script);
}

void write_study_report(const Study& study, const std::vector<Figure>& figures, const fs::path& folder) {
  write_whole(folder / "report.html", study_html(study, figures, folder));
}

}  // namespace sandglass
