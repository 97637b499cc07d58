#include "sandglass/report/curve_math.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

/// y(x) on 60 log-spaced points, x from 0.01 to 100, errors 1 % of y.
Curve sampled(const std::function<double(double)>& y) {
  Curve curve{.name = "c"};
  for (int i = 0; i < 60; ++i) {
    curve.x.push_back(0.01 * std::pow(1e4, i / 59.0));
    curve.y.push_back(y(curve.x.back()));
    curve.error.push_back(0.01 * std::abs(curve.y.back()));
    curve.alternative_x.push_back(7 * curve.x.back());
  }
  return curve;
}

std::vector<Ranked> sequence(std::initializer_list<double> values, double error) {
  std::vector<Ranked> list;
  for (const double value : values) list.push_back({static_cast<double>(list.size()), {value, error}});
  return list;
}

}  // namespace

TEST_CASE("the local exponent of a power law is its exponent; its error that of the ends of the window") {
  const Curve slope = local_exponent(sampled([](double x) { return 3 * std::pow(x, 0.6); }));
  REQUIRE(slope.x.size() > 50);
  for (std::size_t i = 0; i < slope.x.size(); ++i) {
    CHECK(slope.y[i] == doctest::Approx(0.6).epsilon(1e-10));
    CHECK(slope.alternative_x[i] == doctest::Approx(7 * slope.x[i]));
  }
  // Neighbours are a factor 10^(4/59) = 1.169 apart: the window of 1.5 holds two on each side, 0.6245 in ln x.
  CHECK(slope.error[30] == doctest::Approx(std::sqrt(2) * 0.01 / (4 * 4 * std::log(10) / 59)));
}

TEST_CASE("a straight line has its slope as derivative, a parabola its chord") {
  for (const double y : derivative(sampled([](double x) { return 2 + 5 * x; })).y) CHECK(y == doctest::Approx(5));
  const Curve d = derivative(sampled([](double x) { return x * x; }));
  for (std::size_t i = 0; i < d.x.size(); ++i) CHECK(std::abs(d.y[i] / (2 * d.x[i]) - 1) < 0.06);  // cosh(0.31) = 1.05
}

TEST_CASE("values between points, and none outside") {
  const Curve curve = sampled([](double x) { return std::log(x); });
  CHECK(value_at(curve, 3).value == doctest::Approx(std::log(3)));  // straight in ln x
  CHECK(value_at(curve, curve.x[5]).value == curve.y[5]);
  CHECK(std::isnan(value_at(curve, 0.009).value));
  CHECK(std::isnan(value_at(curve, 101).value));
  CHECK(std::isnan(value_at({}, 1).value));
}

TEST_CASE("points that are known well enough") {
  Curve curve{.name = "", .x = {1, 2, 3}, .y = {5, 6, 7}};
  const auto keep = [](double y, double error) { return error < y / 10; };
  CHECK(points_known(curve, keep).x.empty());
  curve.error = {0.1, 3, NAN};
  CHECK(points_known(curve, keep).x == std::vector{1.0});
  CHECK(points_known(curve, keep).error == std::vector{0.1});
}

TEST_CASE("a crossing is where the law says, its error the error of y over the slope") {
  const Measured up = crossing(sampled([](double x) { return 0.2 * std::pow(x, 0.5); }), 1);
  CHECK(up.value == doctest::Approx(25));
  // dy/dx = y / (2 x): error = 0.01 y / (y / 2 x) = 0.02 x, to the curvature within a step.
  CHECK(up.error == doctest::Approx(0.5).epsilon(0.05));
  CHECK(crossing(sampled([](double x) { return 4 / x; }), 1).value == doctest::Approx(4));
  CHECK(std::isnan(crossing(sampled([](double) { return 2.0; }), 1).value));
}

TEST_CASE("a number of the paper") {
  const Measured paper{0.547, 0.006};
  CHECK(compare("", {0.55, 0.006}, paper, "").outcome == Outcome::agrees);
  CHECK(compare("", {0.45, 0.01}, paper, "").outcome == Outcome::differs);
  CHECK(compare("", {0.45, 0.01}, paper, "").finding.find("lower by 0.097") != std::string::npos);
  // Two standard errors of the difference, sqrt(0.008^2 + 0.006^2) = 0.01.
  CHECK(compare("", {0.547 + 0.0199, 0.008}, paper, "").outcome == Outcome::agrees);
  CHECK(compare("", {0.547 + 0.0201, 0.008}, paper, "").outcome == Outcome::differs);
  CHECK(compare("", {0.547, Measured{}.error}, paper, "").outcome == Outcome::not_enough_data);
  CHECK(compare("", {}, paper, "").outcome == Outcome::not_enough_data);
}

TEST_CASE("orders") {
  CHECK(rises("", sequence({1, 2, 3}, 0.1), "y", "x").outcome == Outcome::agrees);
  CHECK(falls("", sequence({1, 2, 3}, 0.1), "y", "x").outcome == Outcome::differs);
  CHECK(rises("", sequence({1, 3, 2}, 0.1), "y", "x").outcome == Outcome::differs);
  CHECK(rises("", sequence({1, 3, 2.9}, 0.1), "y", "x").outcome == Outcome::agrees);  // a step back within the errors
  CHECK(rises("", sequence({1, 1.1, 1.2}, 0.1), "y", "x").outcome == Outcome::not_enough_data);
  CHECK(rises("", sequence({1}, 0.1), "y", "x").outcome == Outcome::not_enough_data);
  CHECK(rises("", sequence({1, 2, 3}, Measured{}.error), "y", "x").outcome == Outcome::not_enough_data);
}

TEST_CASE("several sequences as one: without data there is no agreement") {
  const Check yes{"", Outcome::agrees, "yes."}, no{"", Outcome::differs, "no."},
      open{"", Outcome::not_enough_data, "?"};
  CHECK(joined("", std::vector{yes, open}).outcome == Outcome::agrees);
  CHECK(joined("", std::vector{yes, no, open}).outcome == Outcome::differs);
  CHECK(joined("", std::vector{open, open}).outcome == Outcome::not_enough_data);
  CHECK(joined("", {}).outcome == Outcome::not_enough_data);
  CHECK(joined("", std::vector{yes, no, open}).finding == "Of 3 sequences 1 agree, 1 differ, 1 lack data. no.");
}

}  // namespace sandglass
