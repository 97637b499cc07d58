// Figures 11 and 12: how positions are forgotten.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/correlation.h"
#include "sandglass/report/number.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/point_family.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

/// S_inc(k, t) of the small disks.
std::optional<Curve> scattering(const StatePoint& point, double k) {
  return small_curve(point, "self_intermediate_scattering", k);
}

/// tau: S_inc(k, tau) = 1/2.
Measured relaxation_time(const StatePoint& point, double k) {
  const auto curve = scattering(point, k);
  return curve ? crossing(*curve, 0.5) : Measured{};
}

/// S_inc(k, t) at the densities of the paper.
Figure scattering_figure(int number, double k, const Family& family, std::string caption, std::string statement) {
  Figure figure =
      paper_figure(number, fmt::format("Incoherent scattering, k = {:g}, ε = {:g}", k, family.fixed),
                   std::move(caption), lag_axis, {fmt::format("S_inc({:g}, t)", k), "", false}, std::move(statement));
  figure.alternative_x = collisions_axis;
  add_family(figure, family, paper_densities, figure.y.label, [k](const StatePoint& p) { return scattering(p, k); });
  return figure;
}

Figure slow_scattering(const Study& study) {
  constexpr double k = 0.5;
  const Family family = densities_at(study, shown_restitution(study, 0.9));
  Figure figure = scattering_figure(11, k, family,
                                    "Small disks: memory of positions on the length 2π/k = 12.6 Rₛ. Inset: the "
                                    "relaxation time τ, S_inc(0.5, τ) = 1/2.",
                                    "τ diverges on approach to the glass transition.");
  Figure inset = part_of(figure, "_tau", "Relaxation time", {"η", "", false}, {"τ", "", true});
  Curve curve{.name = "τ(0.5)", .role = Role::small};
  for (const StatePoint* point : family.points) {
    const Measured tau = relaxation_time(*point, k);
    if (!std::isfinite(tau.value)) continue;
    curve.x.push_back(point->packing_fraction());
    curve.y.push_back(tau.value);
    curve.error.push_back(tau.error);
  }
  const Check growth = rises("τ grows with η", ranked(curve), "τ", "η");
  Check divergence{"τ diverges: d ln τ / dη at the highest densities exceeds that at the lowest",
                   Outcome::not_enough_data, "τ is known at fewer than three densities."};
  if (curve.x.size() >= 3) {
    const std::size_t n = curve.x.size();
    const auto slope = [&](std::size_t a, std::size_t b) -> Measured {
      const double width = curve.x[b] - curve.x[a];
      return {std::log(curve.y[b] / curve.y[a]) / width,
              std::hypot(curve.error[a] / curve.y[a], curve.error[b] / curve.y[b]) / width};
    };
    const Measured low = slope(0, 1), high = slope(n - 2, n - 1);
    const double difference = high.value - low.value, error = standard_error_of_difference(low, high);
    const bool near_transition = curve.x[n - 1] > 0.7499;  // far below it τ grows faster and faster, too
    if (near_transition && std::abs(difference) > significant_order * error)
      divergence.outcome = difference > 0 ? Outcome::agrees : Outcome::differs;
    divergence.finding =
        fmt::format("d ln τ / dη is {} at η = {:g} and {} at {:g}{}.", with_error(low.value, low.error),
                    (curve.x[0] + curve.x[1]) / 2, with_error(high.value, high.error),
                    (curve.x[n - 2] + curve.x[n - 1]) / 2, near_transition ? "" : "; τ is not known at η ≥ 0.75");
  }
  if (!curve.x.empty()) {
    inset.curves = {std::move(curve)};
    figure.insets = {std::move(inset)};
  }
  figure.checks = {growth, divergence};
  return figure;
}

/// The greatest |S - Gaussian| of a curve, with the error of S there.
Measured deviation(const StatePoint& point, double k, double until) {
  const auto s = scattering(point, k);
  const auto gaussian = small_curve(point, "gaussian_approximation", k);
  Measured worst;
  if (!s || !gaussian || s->x != gaussian->x || s->error.empty()) return worst;
  for (std::size_t i = 0; i < s->x.size() && s->x[i] <= until; ++i) {
    const double difference = std::abs(s->y[i] - gaussian->y[i]);
    if (!(difference <= worst.value)) worst = {difference, s->error[i]};
  }
  return worst;
}

Check gaussian_check(const Family& family, bool dense) {
  constexpr double k = 3, tolerance = 0.02;
  Check check{
      dense ? "At the highest densities (η ≥ 0.78) the Gaussian approximation fails at long times (by more than 0.02)"
            : "At low density (η ≤ 0.3) the Gaussian approximation holds at all times (within 0.02)",
      Outcome::not_enough_data, dense ? "There is no run at η ≥ 0.78." : "There is no run at η ≤ 0.3."};
  const StatePoint* point = nullptr;  // where it is clearest
  Measured worst;
  const auto clarity = [&](const Measured& m) { return (m.value - tolerance) / m.error; };
  for (const StatePoint* p : family.points) {
    if (dense ? p->packing_fraction() < 0.7799 : p->packing_fraction() > 0.3001) continue;
    const Measured found = deviation(*p, k, INFINITY);
    if (std::isfinite(found.value) && (point == nullptr || clarity(found) > clarity(worst))) point = p, worst = found;
  }
  if (point == nullptr) return check;
  const bool fails = worst.value > tolerance + significant_order * worst.error;
  const bool unclear = !fails && worst.value > tolerance;
  check.outcome = unclear ? Outcome::not_enough_data : fails == dense ? Outcome::agrees : Outcome::differs;
  if (dense && !fails) check.outcome = Outcome::not_enough_data;  // a longer run may still show it
  check.finding = fmt::format("At η = {:g} the two differ by at most {}.", point->packing_fraction(),
                              with_error(worst.value, worst.error));
  return check;
}

enum class Decay : std::uint8_t { two_steps, one_step, unclear };

/// Two steps: the slope against ln t has a minimum between two maxima, by `significant_order` errors each. One: S falls
/// below 0.1, and up to there no slope is lower than one before and one after it by even one error.
Decay decay_of(const Curve& s) {
  constexpr std::size_t reach = 2;  // points to both sides of a slope
  constexpr double forgotten = 0.1;
  std::vector<double> slope, error;
  for (std::size_t i = reach; i + reach < s.x.size(); ++i) {
    const double width = std::log(s.x[i + reach] / s.x[i - reach]);
    slope.push_back((s.y[i - reach] - s.y[i + reach]) / width);
    error.push_back(std::hypot(s.error[i - reach], s.error[i + reach]) / width);
  }
  double deepest = 0;  // in standard errors: of the two maxima the less clear one
  for (std::size_t i = 0; i < slope.size() && s.y[i + reach] > forgotten; ++i) {
    double before = 0, after = 0;
    for (std::size_t j = 0; j < slope.size(); ++j) {
      double& side = j < i ? before : after;
      side = std::fmax(side, (slope[j] - slope[i]) / std::hypot(error[i], error[j]));  // fmax passes over NaN
    }
    deepest = std::max(deepest, std::min(before, after));
  }
  if (deepest > significant_order) return Decay::two_steps;
  return deepest < 1 && s.y.back() < forgotten ? Decay::one_step : Decay::unclear;
}

Check two_steps(const Family& family) {
  Check check{"S_inc(3, t) decays in two steps for η ≥ 0.78: its slope against ln t has a minimum between two maxima",
              Outcome::not_enough_data, "There is no run at η ≥ 0.78."};
  std::string two, one, unclear;
  for (const StatePoint* point : family.points) {
    const auto s = scattering(*point, 3);
    if (!s || s->y.empty() || point->packing_fraction() < 0.7799 || s->error.empty()) continue;
    const Decay decay = decay_of(*s);
    (decay == Decay::two_steps  ? two
     : decay == Decay::one_step ? one
                                : unclear) += fmt::format(" {:g}", point->packing_fraction());
  }
  if (two.empty() && one.empty() && unclear.empty()) return check;
  check.outcome = !one.empty()                      ? Outcome::differs
                  : !two.empty() && unclear.empty() ? Outcome::agrees
                                                    : Outcome::not_enough_data;
  check.finding = fmt::format("Two steps at η ={}", two.empty() ? " none" : two);
  if (!one.empty()) check.finding += "; a single one, down to where all is forgotten, at" + one;
  if (!unclear.empty()) check.finding += "; not clear, or the run is too short, at" + unclear;
  check.finding += ".";
  return check;
}

Figure fast_scattering(const Study& study) {
  constexpr double k = 3;
  const Family family = densities_at(study, shown_restitution(study, 0.9));
  Figure figure = scattering_figure(12, k, family,
                                    "Small disks, memory on the length 2π/k = 2.1 Rₛ. Right, dashed: the Gaussian "
                                    "approximation exp(−k²⟨Δr²⟩/4), at some densities.",
                                    "Two-step decay for η ≥ 0.78. The Gaussian approximation holds at all times at low "
                                    "density, only at short times at the highest.");
  Figure panel = part_of(figure, "b", "With the Gaussian approximation", lag_axis, figure.y);
  panel.alternative_x = collisions_axis;
  const Family few = few_of(family, std::array{0.3, 0.72, 0.78, 0.81});
  add_family(panel, few, {}, "S_inc(3, t)", [](const StatePoint& p) { return scattering(p, k); });
  Figure gaussians = panel;
  gaussians.curves.clear();
  add_family(gaussians, few, {}, "", [](const StatePoint& p) {
    auto curve = small_curve(p, "gaussian_approximation", k);
    if (curve) {
      curve->name = fmt::format("η = {:g}, Gaussian", p.packing_fraction());
      curve->line = Line::dashed;
      curve->error.clear();
    }
    return curve;
  });
  panel.curves.insert(panel.curves.end(), gaussians.curves.begin(), gaussians.curves.end());
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  figure.checks = {two_steps(family), gaussian_check(family, false), gaussian_check(family, true)};
  return figure;
}

}  // namespace

void add_scattering_figures(const Study& study, std::vector<Figure>& figures) {
  figures.push_back(slow_scattering(study));
  figures.push_back(fast_scattering(study));
}

}  // namespace sandglass
