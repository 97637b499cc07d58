// What is read off a measured curve, with errors: slopes, passages, integrals; and the rules of the verdicts.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sandglass/report/figure_data.h"
#include "sandglass/study/merge.h"

namespace sandglass {

/// d ln y / d ln x at each point: difference quotient between the outermost points inside [x / spread, x spread],
/// equally many on both sides; a point without neighbours on both sides has none. Errors of the two ends are taken as
/// independent, which is too much where they come from the same displacements.
Curve local_exponent(const Curve& curve, double spread = 1.5);

/// dy / dx in the same way.
Curve derivative(const Curve& curve, double spread = 1.5);

/// y at x, linear in ln x between neighbours; NaN outside the curve.
Measured value_at(const Curve& curve, double x);

/// The first x at which the curve reaches `level` from either side, linear in ln x and, where y > 0, in ln y; error =
/// error of y / |slope|. NaN when it never does.
Measured crossing(const Curve& curve, double level);

/// The points (x, y) of the curve that `keep` wants.
Curve points_where(const Curve& curve, const std::function<bool(double x, double y)>& keep);

/// The points whose value and standard error `keep` wants; none of a curve without errors.
Curve points_known(const Curve& curve, const std::function<bool(double y, double error)>& keep);

/// The part of the curve with from <= x <= to.
Curve between(const Curve& curve, double from, double to);

/// How many standard errors make a difference. An order is read off many pairs of neighbours, where two would be
/// exceeded by chance again and again; an extreme value is looked for among all points of a curve.
inline constexpr double significant = 2, significant_order = 3, significant_extreme = 5;

double standard_error_of_difference(const Measured& a, const Measured& b);

/// `found` against a number of the paper: agrees within `significant` standard errors of the difference.
Check compare(std::string claim, const Measured& found, const Measured& paper, const std::string& where);

/// One value of a sequence that should rise (or fall) with its argument.
struct Ranked {
  double argument = 0;
  Measured value;
};

/// A sequence by ascending argument. Differs if any step goes the wrong way, agrees if none does and the last exceeds
/// the first, each by more than `significant_order` standard errors. Values without an error are not used.
Check rises(std::string claim, std::span<const Ranked> sequence, const std::string& what, const std::string& argument);
Check falls(std::string claim, std::span<const Ranked> sequence, const std::string& what, const std::string& argument);

/// An exponent and what it belongs to.
struct NamedExponent {
  std::string name;
  Measured exponent;
};

/// Whether not all curves are flat. Agrees if any exponent differs from zero by more than `significant_order` standard
/// errors; differs if all are zero within these, known to 0.05 and at least two: one flat curve does not say that all
/// are. `heading` begins the finding; `lacking` is the finding without data.
Check not_all_flat(std::string claim, std::string lacking, std::span<const NamedExponent> exponents,
                   const std::string& heading);

/// Checks of several families as one: differs if any does, agrees if at least one does and none differs.
Check joined(std::string claim, std::span<const Check> parts);

}  // namespace sandglass
