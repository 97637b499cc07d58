#include "sandglass/report/figure_data.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/synthetic_run.test.h"

namespace sandglass {
namespace {

using Results = std::vector<Dataset>;

const Figure& figure(const std::vector<Figure>& figures, const std::string& id) {
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.id == id; });
  REQUIRE_MESSAGE(found != figures.end(), id);
  return *found;
}

const Curve& curve(const Figure& f, const std::string& start) {
  const auto found =
      std::find_if(f.curves.begin(), f.curves.end(), [&](const Curve& c) { return c.name.starts_with(start); });
  REQUIRE_MESSAGE(found != f.curves.end(), start);
  return *found;
}

std::vector<double>& values(Results& results, const std::string& path) {
  const auto found = std::find_if(results.begin(), results.end(), [&](const Dataset& d) { return d.path == path; });
  REQUIRE_MESSAGE(found != results.end(), path);
  return std::get<std::vector<double>>(found->values);
}

void remove(Results& results, const std::string& part) {
  std::erase_if(results, [&](const Dataset& d) { return d.path.find(part) != std::string::npos; });
}

}  // namespace

TEST_CASE("every curve carries its points, errors and second axis") {
  Results results = synthetic_results();
  const auto figures = run_figures(results, synthetic_summary());
  const Curve& small = curve(figure(figures, "msd"), "small");
  const std::string group = "/dynamics/small/mean_square_displacement";
  CHECK(small.x == values(results, group + "/time"));
  CHECK(small.alternative_x == values(results, group + "/collisions"));
  CHECK(small.y == values(results, group + "/value"));
  CHECK(small.error == values(results, group + "/error"));
  for (const Figure& f : figures) {
    CHECK(f.missing.empty());
    REQUIRE(!f.curves.empty());
    for (const Curve& c : f.curves) {
      CHECK(!c.name.empty());
      CHECK(!c.y.empty());
      CHECK(c.x.size() == c.y.size());
      CHECK((c.error.empty() || c.error.size() == c.y.size()));
      CHECK((c.alternative_x.empty() ? f.alternative_x.label.empty() : c.alternative_x.size() == c.y.size()));
    }
  }
}

TEST_CASE("the fitted line has the exponent of the summary and runs through the data of its range") {
  Results results = synthetic_results();
  auto& time = values(results, "/dynamics/small/mean_square_displacement/time");
  auto& square = values(results, "/dynamics/small/mean_square_displacement/value");
  for (std::size_t i = 0; i < time.size(); ++i) square[i] = 0.3 * std::pow(time[i], 0.47);
  Summary summary = synthetic_summary();
  summary.msd_exponent.small = {0.47, 0.011, 1, 10};
  const Figure msd = run_figures(results, summary).front();
  const Curve& fit = curve(msd, "fit: exponent 0.470(11)");
  REQUIRE(fit.x.size() >= 10);
  CHECK(fit.x.front() >= 1);
  CHECK(fit.x.back() <= 10);
  for (std::size_t i = 0; i < fit.x.size(); ++i)  // log and exp of numbers of order one: some 1e-15
    CHECK(fit.y[i] == doctest::Approx(0.3 * std::pow(fit.x[i], 0.47)).epsilon(1e-12));

  CHECK(msd.caption.find("only up to") == std::string::npos);

  summary.msd_exponent.small = {0.47, 0.011, 1, 100};  // the data end at t = 34
  CHECK(run_figures(results, summary).front().caption.find("only up to t = 34.1") != std::string::npos);

  summary.msd_exponent.small = {};
  const Figure without = run_figures(results, summary).front();
  CHECK(std::none_of(without.curves.begin(), without.curves.end(), [](const Curve& c) { return c.role == Role::fit; }));
  CHECK(without.caption.find("No exponent") != std::string::npos);
}

TEST_CASE("the velocity autocorrelation is normalised, its negative part shown only where it is beyond the error") {
  Results results = synthetic_results();
  auto figures = run_figures(results, synthetic_summary());
  const Curve& big = curve(figure(figures, "vacf"), "big");
  const double at_zero = values(results, "/dynamics/big/velocity_autocorrelation/equal_time_value").front();
  CHECK(big.y[5] == values(results, "/dynamics/big/velocity_autocorrelation/value")[5] / at_zero);
  CHECK(big.error[5] == values(results, "/dynamics/big/velocity_autocorrelation/error")[5] / at_zero);
  const Figure& negative = figure(figures, "vacf_negative");
  REQUIRE(negative.y_range);
  CHECK((*negative.y_range)[0] < *std::min_element(big.y.begin(), big.y.end()));

  for (const char* species : {"small", "big", "all"}) {
    for (double& error : values(results, std::string("/dynamics/") + species + "/velocity_autocorrelation/error"))
      error = 0.1;  // the dip is 0.04 Phi(0), at most 0.08
  }
  figures = run_figures(results, synthetic_summary());
  CHECK(std::none_of(figures.begin(), figures.end(), [](const Figure& f) { return f.id == "vacf_negative"; }));
}

TEST_CASE("each wavenumber has its figure with the Gaussian approximation dashed") {
  Results results = synthetic_results();
  const auto figures = run_figures(results, synthetic_summary());
  const auto& value = values(results, "/dynamics/small/self_intermediate_scattering/value");
  const std::size_t lags = value.size() / 2;
  for (std::size_t k = 0; k < 2; ++k) {
    const Figure& f = figure(figures, "scattering_" + std::to_string(k));
    CHECK(f.parameter == (k == 0 ? 0.5 : 3.0));
    CHECK(curve(f, "small").y[7] == value[k * lags + 7]);
    CHECK(curve(f, "small, Gaussian").line == Line::dashed);
  }
}

TEST_CASE("missing or ill-shaped datasets are said, not drawn") {
  const auto empty = run_figures({}, Summary{});
  REQUIRE(!empty.empty());
  for (const Figure& f : empty) {
    CHECK(f.curves.empty());
    CHECK(f.missing.find("The results hold no ") == 0);
  }

  Results results = synthetic_results();
  remove(results, "/dynamics/big/mean_square_displacement/value");
  values(results, "/dynamics/small/velocity_autocorrelation/value").pop_back();
  remove(results, "temperature_small");
  const auto figures = run_figures(results, synthetic_summary());
  CHECK(figure(figures, "msd").missing.find("/dynamics/big/mean_square_displacement") != std::string::npos);
  CHECK(curve(figure(figures, "msd"), "small").x.size() > 0);
  CHECK(figure(figures, "vacf").missing.find("83 values where 84 were expected") != std::string::npos);
  CHECK(figure(figures, "temperature").curves.size() == 2);
  CHECK(figure(figures, "temperature_ratio").curves.empty());
  CHECK(!figure(figures, "temperature_ratio").missing.empty());
}

TEST_CASE("what was not measured is left out of the curve") {
  Results results = synthetic_results();
  values(results, "/dynamics/all/mean_square_displacement/value")[3] = Summary::unknown;
  const auto figures = run_figures(results, synthetic_summary());
  const Curve& all = curve(figure(figures, "msd"), "all");
  CHECK(all.y.size() == 83);
  CHECK(all.error.size() == 83);
  CHECK(all.x[3] == values(results, "/dynamics/all/mean_square_displacement/time")[4]);
}

TEST_CASE("a species without disks has no curves") {
  Results results = synthetic_results();
  for (Dataset& dataset : results) {
    if (dataset.path.find("/big/") == std::string::npos && dataset.path.find("_big") == std::string::npos) continue;
    if (dataset.path.ends_with("/time") || dataset.path.ends_with("/collisions")) continue;
    for (double& value : std::get<std::vector<double>>(dataset.values)) value = Summary::unknown;
  }
  for (const Figure& f : run_figures(results, synthetic_summary())) {
    for (const Curve& c : f.curves) {
      CHECK(c.role != Role::big);
      CHECK(!c.y.empty());
    }
  }
}

}  // namespace sandglass
