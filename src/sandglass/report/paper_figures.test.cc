#include "sandglass/report/paper_figures.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sandglass/report/figure_json.h"
#include "sandglass/report/point_family.h"
#include "sandglass/report/study_page.h"
#include "sandglass/report/synthetic_run.test.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

StatePoint point(double density, double restitution, std::uint64_t particles = 10000, double length = 1e4) {
  StatePoint p;
  p.config.system.packing_fraction = density;
  p.config.collision.restitution = restitution;
  p.config.system.particles = particles;
  p.name = "eta=" + std::to_string(density) + "_eps=" + std::to_string(restitution) + "_N=" + std::to_string(particles);
  Summary summary = synthetic_summary();
  summary.collisions_per_particle = length;
  p.replicas = {{"runs/" + p.name, summary}};
  p.results = synthetic_results();
  p.numbers["collision_rate"] = {85, 0.1};
  p.numbers["temperature/small"] = {1.02, 0.001};
  p.numbers["temperature/big"] = {0.98, 0.001};
  return p;
}

Study study_of(std::vector<StatePoint> points) { return {".", std::move(points), {}, {}}; }

const Figure& figure(const std::vector<Figure>& figures, int number) {
  REQUIRE(figures.size() == figure_count);
  return figures[static_cast<std::size_t>(number - 1)];
}

}  // namespace

TEST_CASE("there are all, in order, with data or the reason why not; the paper's have a statement and a check") {
  const auto figures = paper_figures(study_of({point(0.8, 0.9)}));
  REQUIRE(figures.size() == figure_count);
  for (int n = 1; n <= figure_count; ++n) {
    const Figure& f = figure(figures, n);
    CHECK(f.id == (n < 10 ? "fig0" : "fig") + std::to_string(n));
    CHECK(f.statement.empty() == (n > 17));
    CHECK((n > 17 || !f.checks.empty()));
    CHECK((!f.empty() || !f.missing.empty()));
  }
  CHECK(figure(figures, 5).curves.size() == 1);
  CHECK(figure(figures, 6).empty());
  CHECK(figure(figures, 6).missing.find("no runs at ε = 0.7") != std::string::npos);
  CHECK(figure(figures, 13).missing.find("Not measured") != std::string::npos);
}

TEST_CASE("without data nothing agrees") {
  StatePoint bare = point(0.3, 0.6);
  bare.results.clear();
  bare.numbers.clear();
  for (const Figure& f : paper_figures(study_of({bare}))) {
    CHECK(f.empty());
    CHECK(verdict(f) == Outcome::not_enough_data);
    CHECK(!f.missing.empty());
  }
}

TEST_CASE("the exponent is held against the paper's only at its point") {
  StatePoint p = point(0.81, 0.9);
  p.numbers["msd_exponent/small/value"] = {0.55, 0.004};
  CHECK(figure(paper_figures(study_of({p})), 5).checks[0].outcome == Outcome::agrees);
  p.numbers["msd_exponent/small/value"] = {0.45, 0.004};
  CHECK(figure(paper_figures(study_of({p})), 5).checks[0].outcome == Outcome::differs);
  StatePoint other = point(0.8, 0.9);
  other.numbers["msd_exponent/small/value"] = {0.55, 0.004};
  CHECK(figure(paper_figures(study_of({other})), 5).checks[0].outcome == Outcome::not_enough_data);
}

TEST_CASE("T_s > T_b needs the paper's point and a difference beyond the errors") {
  CHECK(figure(paper_figures(study_of({point(0.5, 0.9)})), 1).checks[0].outcome == Outcome::agrees);
  StatePoint equal = point(0.5, 0.9);
  equal.numbers["temperature/big"] = {1.02, 0.001};
  CHECK(figure(paper_figures(study_of({equal})), 1).checks[0].outcome == Outcome::not_enough_data);
  StatePoint reverse = point(0.5, 0.9);
  reverse.numbers["temperature/big"] = {1.05, 0.001};
  CHECK(figure(paper_figures(study_of({reverse})), 1).checks[0].outcome == Outcome::differs);
  const Figure elsewhere = figure(paper_figures(study_of({point(0.8, 0.7)})), 1);
  CHECK(elsewhere.checks[0].outcome == Outcome::not_enough_data);
  CHECK(elsewhere.missing.find("nearest") != std::string::npos);
  CHECK(!elsewhere.empty());
}

TEST_CASE("of several points at one place the longest is shown, or the largest") {
  const Study study = study_of({point(0.5, 0.9, 10000, 1e5), point(0.5, 0.9, 400000, 1e3), point(0.6, 0.9)});
  const Family longest = densities_at(study, 0.9), largest = densities_at(study, 0.9, Prefer::largest);
  REQUIRE(longest.points.size() == 2);
  CHECK(longest.points[0]->config.system.particles == 10000);
  CHECK(largest.points[0]->config.system.particles == 400000);
}

TEST_CASE("of many densities those nearest to the chosen ones are shown") {
  const Study study = study_of({point(0.5, 0.9), point(0.6, 0.9), point(0.7, 0.9), point(0.8, 0.9), point(0.82, 0.9)});
  const Family few = few_of(densities_at(study, 0.9), std::array{0.5, 0.71, 0.81});
  REQUIRE(few.points.size() == 3);
  CHECK(few.level(*few.points[0]) == 0.5);
  CHECK(few.level(*few.points[1]) == 0.7);
  CHECK(few.level(*few.points[2]) == 0.8);  // of two as near the lower one
  CHECK(few_of(densities_at(study, 0.9), std::array{0.1, 0.2}).points.size() == 5);
}

TEST_CASE("temperatures of one run have the scatter of their disks as band") {
  const Figure f = figure(paper_figures(study_of({point(0.5, 0.9, 5000)})), 1);
  REQUIRE(f.curves.size() == 2);
  for (const Curve& curve : f.curves) {
    REQUIRE(curve.error.size() == curve.y.size());
    for (std::size_t i = 0; i < curve.y.size(); ++i)
      CHECK(curve.error[i] == doctest::Approx(curve.y[i] / 50));  // 2500 disks of each species
  }
}

TEST_CASE("a correlation length is shown where it is known and inside its range") {
  const auto shown = [](const Measured& length) {
    StatePoint p = point(0.8, 0.9);
    p.replicas[0].summary.box_length = 200;  // the longest is 31.8
    p.numbers["velocity_correlation_length"] = length;
    const Figure f = figure(paper_figures(study_of({p})), 23);
    return std::any_of(f.panels.begin(), f.panels.end(), [](const Figure& panel) { return panel.id == "fig23c"; });
  };
  CHECK(shown({8, 1}));
  CHECK_FALSE(shown({8, 5}));
  CHECK_FALSE(shown({8, NAN}));
  CHECK_FALSE(shown({31.8, 1e-14}));
  CHECK_FALSE(shown({1, 1e-14}));
}

TEST_CASE("a line of equal t is where the curves pass it") {
  Figure f;
  for (const double e : {0.5, 0.9}) {
    Curve curve{.name = "", .role = Role::family, .level = e};
    for (const double density : {0.6, 0.7, 0.8}) {
      curve.x.push_back(density);
      curve.y.push_back(std::pow(density / 0.7, 20 * e));
      curve.error.push_back(0.01);
    }
    f.curves.push_back(curve);
  }
  const Curve line = iso_line(f, 2, "t = 2");
  REQUIRE(line.x == std::vector{0.5, 0.9});
  CHECK(line.y[0] == doctest::Approx(0.7 * std::pow(2, 1.0 / 10)));  // ln y is straight in ln x
  CHECK(line.y[1] == doctest::Approx(0.7 * std::pow(2, 1.0 / 18)));
}

TEST_CASE("a peak counts only where the curve comes down behind it, and disks get away") {
  const auto with_peak = [](double density, double height, double end, double far = 2) {
    StatePoint p = point(density, 0.9);
    p.results.clear();
    const auto put = [&](const std::string& quantity, std::vector<double> values) {
      const std::string group = "/dynamics/small/" + quantity + "/";
      for (const auto& [name, column] : {std::pair{"time", std::vector<double>{1, 2, 3}},
                                         {"collisions", {1, 2, 3}},
                                         {"value", std::move(values)},
                                         {"error", {0.1, 0.1, 0.1}}})
        p.results.push_back({group + name, {3}, column, ""});
    };
    put("susceptibility", {1, height, end});
    put("mean_square_displacement", {0.1, 0.2, far});
    return p;
  };
  const auto outcome = [](std::vector<StatePoint> points) {
    return figure(paper_figures(study_of(std::move(points))), 20).checks[0].outcome;
  };
  CHECK(outcome({with_peak(0.7, 2, 1), with_peak(0.78, 5, 1)}) == Outcome::agrees);
  CHECK(outcome({with_peak(0.7, 5, 1), with_peak(0.78, 2, 1)}) == Outcome::differs);
  CHECK(outcome({with_peak(0.7, 5, 1), with_peak(0.78, 2, 1, 0.5)}) == Outcome::not_enough_data);  // a rattling one
  CHECK(outcome({with_peak(0.7, 5, 1), with_peak(0.78, 2, 2)}) == Outcome::not_enough_data);
  CHECK(outcome({with_peak(0.5, 5, 1), with_peak(0.6, 2, 1)}) == Outcome::not_enough_data);  // no cages there
}

TEST_CASE("fast and slow disks are judged at the lag by which they were told apart") {
  StatePoint p = point(0.8, 0.9);
  p.config.observe.selection_time = 1000;
  const auto put = [&](const std::string& speed, std::vector<double> values) {
    const std::string group = "/dynamics/small/mobility/" + speed + "/";
    for (const auto& [name, column] : {std::pair{"time", std::vector<double>{1, 800, 975, 1190}},
                                       {"collisions", {1, 2, 3, 4}},
                                       {"value", std::move(values)},
                                       {"error", {0.01, 0.01, 0.01, 0.01}}})
      p.results.push_back({group + name, {4}, column, ""});
  };
  put("fastest", {0.1, 8, 9, 9});
  put("slowest", {0.1, 0.5, 0.05, 1});
  const Figure f = figure(paper_figures(study_of({p})), 13);
  REQUIRE(f.checks.size() == 2);
  CHECK(f.checks[0].outcome == Outcome::agrees);
  CHECK(f.checks[1].outcome == Outcome::agrees);
  CHECK(f.checks[1].finding.find("t = 975") != std::string::npos);
}

TEST_CASE("energy that goes in and does not come out is no steady state") {
  StatePoint p = point(0.7, 0.9);
  p.numbers["energy/injected"] = {10, 0}, p.numbers["energy/dissipated"] = {10.001, 0},
  p.numbers["energy/balance"] = {0, 0};
  CHECK(figure(paper_figures(study_of({p})), 24).checks[0].outcome == Outcome::agrees);
  p.numbers["energy/dissipated"] = {10.1, 0};
  CHECK(figure(paper_figures(study_of({p})), 24).checks[0].outcome == Outcome::differs);
  p.numbers["energy/dissipated"] = {10, 0}, p.numbers["energy/balance"] = {1e-6, 0};
  CHECK(figure(paper_figures(study_of({p})), 24).checks[0].outcome == Outcome::differs);
}

TEST_CASE("the exponent of a long-time tail is found where the tail stands out of the noise") {
  auto tail_check = [](double exponent, double noise) {
    StatePoint p = point(0.4, 0.7, 1000000);
    auto values = [&](const std::string& name) -> std::vector<double>& {
      const std::string path = "/dynamics/small/velocity_autocorrelation/" + name;
      return std::get<std::vector<double>>(
          std::find_if(p.results.begin(), p.results.end(), [&](const Dataset& d) { return d.path == path; })->values);
    };
    auto &s = values("collisions"), &y = values("value"), &error = values("error");
    for (std::size_t i = 0; i < s.size(); ++i) {
      s[i] = 0.1 * std::pow(1.2, static_cast<double>(i));
      y[i] = std::pow(s[i] + 1, exponent);
      error[i] = noise * y[i];
    }
    REQUIRE(s.back() > 100);
    return figure(paper_figures(study_of({p})), 2).checks.front();
  };
  // d ln(s + 1) / d ln s is ln(101 / 11) / ln 10 = 0.963 on average over the tail: an exponent of -1.06.
  CHECK(tail_check(-1.1, 0.02).outcome == Outcome::agrees);
  CHECK(tail_check(-1.1, 0.02).finding.find(" -1.06") != std::string::npos);
  CHECK(tail_check(-1.6, 0.02).outcome == Outcome::differs);
  CHECK(tail_check(-1.1, 0.6).outcome == Outcome::not_enough_data);
}

TEST_CASE("CSV and JSON hold every point, text is quoted") {
  Figure f{.id = "fig99", .title = "99. A \"title\"\nof two lines", .caption = "", .x = {"x", "", false}};
  f.curves = {{.name = "a,b", .x = {1, 2}, .y = {3, Measured{}.value}, .error = {0.5, 0.5}}};
  f.map = HeatMap{.columns = 2, .rows = 1, .values = {5, 6}};
  const std::string csv = figure_csv(f);
  CHECK(csv.find("\n# ") != std::string::npos);
  CHECK(csv.find("\nfig99,\"a,b\",,1,,3,0.5,\n") != std::string::npos);
  CHECK(csv.find("\nfig99,\"a,b\",,2,,,0.5,\n") != std::string::npos);
  CHECK(csv.find(",1,,0,,6\n") != std::string::npos);
  const auto json = nlohmann::json::parse(figure_json(f).dump());
  CHECK(json["curves"][0]["y"][0] == 3);
  CHECK(json["curves"][0]["y"][1].is_null());
  CHECK(json["map"]["values"][1] == 6);
}

TEST_CASE("links of the page are relative and percent-encoded, text stays text") {
  CHECK(url_of("runs/eta=0.8 #1/<b>/report.html") == "runs/eta%3D0.8%20%231/%3Cb%3E/report.html");
  Study study = study_of({point(0.8, 0.9)});
  study.folder = "/data/study";
  study.points[0].replicas[0].path = "javascript:alert(1)";
  study.absent = {{"</script><script>alert(1)</script>", "<img src=x>"}};
  const std::string html = study_html(study, paper_figures(study), "/data/study/out");
  CHECK(html.find("\"href\":\"../javascript%3Aalert%281%29/report.html\"") != std::string::npos);
  CHECK(html.find("<script>alert") == std::string::npos);
  CHECK(html.find("<img") == std::string::npos);
}

}  // namespace sandglass
