// Figures 1 to 4: temperatures, and how velocities are forgotten.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/number.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/point_family.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

constexpr double tail_from = 10, tail_to = 100;       // collisions per disk over which tails are compared
constexpr std::uint64_t particles_for_tails = 10000;  // in smaller boxes sound comes back within the tail

Curve history(const StatePoint& point, const std::string& name, std::string label, Role role) {
  Curve curve{.name = std::move(label), .role = role};
  const auto time = numbers_of(point.results, "/timeseries/time"), y = numbers_of(point.results, "/timeseries/" + name);
  const auto error = numbers_of(point.results, "/timeseries/" + name + "_error");
  for (std::size_t i = 0; i < time.size() && time.size() == y.size(); ++i) {
    if (!std::isfinite(y[i])) continue;
    curve.x.push_back(time[i]);
    curve.y.push_back(y[i]);
    if (error.size() == y.size()) curve.error.push_back(error[i]);
  }
  return curve;
}

/// The temperature of a species. Where replicas do not tell its error it is T / sqrt(n), by which that of n disks
/// scatters at a moment.
Curve temperature_history(const StatePoint& point, const std::string& species, std::string label, Role role) {
  Curve curve = history(point, "temperature_" + species, std::move(label), role);
  const auto& system = point.config.system;
  const double share = role == Role::big ? system.big_fraction : 1 - system.big_fraction;
  const double disks = share * static_cast<double>(system.particles);
  curve.error.resize(curve.y.size(), Measured{}.error);
  for (std::size_t i = 0; i < curve.y.size(); ++i)
    if (!std::isfinite(curve.error[i])) curve.error[i] = curve.y[i] / std::sqrt(disks);
  return curve;
}

Figure temperatures(const Study& study) {
  Figure figure = paper_figure(1, "Temperatures of small and big disks",
                               "From the Gaussian start at T = T₀ to the steady state. Bands: T/√n, by which the "
                               "temperature of n disks scatters at a moment. Inset: collisions per disk.",
                               {"time t since the start", "Rₛ √(mₛ/T₀)", true}, {"temperature T", "T₀", false},
                               "T_s and T_b become steady, with T_s > T_b (η = 0.5, ε = 0.9); collisions accumulate "
                               "at a steady rate.");
  const StatePoint* point = shown_point(study, 0.5, 0.9, figure, [](const StatePoint& p) {
    return find_dataset(p.results, "/timeseries/temperature_small") != nullptr;
  });
  Check check{"T_s > T_b at η = 0.5, ε = 0.9", Outcome::not_enough_data, "There is no run at this point."};
  if (point != nullptr) {
    figure.curves = {temperature_history(*point, "small", "T_s, small", Role::small),
                     temperature_history(*point, "big", "T_b, big", Role::big)};
    Figure inset = part_of(figure, "_collisions", "Collisions per disk", {"t", "", false}, {"s", "", false});
    inset.curves = {history(*point, "collisions", "s", Role::all)};
    figure.insets = {std::move(inset)};
  }
  if (is_point(point, 0.5, 0.9)) {
    const Measured small = point->number("temperature/small"), big = point->number("temperature/big");
    const double difference = small.value - big.value, error = standard_error_of_difference(small, big);
    check.finding =
        fmt::format("T_s = {}, T_b = {}.", with_error(small.value, small.error), with_error(big.value, big.error));
    if (std::isfinite(error) && std::abs(difference) > significant * error)
      check.outcome = difference > 0 ? Outcome::agrees : Outcome::differs;
    else
      check.finding += " The difference is within the errors, or these are not known.";
  }
  figure.checks = {check};
  return figure;
}

/// Phi(s) / Phi(0) of the small disks against collisions per disk.
std::optional<Curve> velocity_curve(const StatePoint& point) {
  auto curve = small_curve(point, "velocity_autocorrelation");
  const auto at_zero = numbers_of(point.results, "/dynamics/small/velocity_autocorrelation/equal_time_value");
  if (!curve || at_zero.empty() || !(at_zero.front() > 0)) return std::nullopt;
  for (double& y : curve->y) y /= at_zero.front();
  for (double& e : curve->error) e /= at_zero.front();
  return against_collisions(std::move(*curve));
}

/// What stands out of the noise: up to the first point below twice its error.
Curve significant_part(const Curve& curve) {
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    if (!curve.error.empty() && !(curve.y[i] > 2 * curve.error[i]))
      return between(curve, 0, std::nextafter(curve.x[i], 0));
  return curve;
}

/// Exponent of y ~ s^a over the tail: least squares of ln y against ln s. The error is that of the lags, which are
/// taken as independent. NaN where the curve does not stand out of the noise to the tail's end.
Measured tail_exponent(const Curve& curve) {
  const Curve tail = between(curve, tail_from, tail_to);
  const std::size_t n = tail.x.size();
  if (n < 5 || tail.x.back() < 0.8 * tail_to || tail.error.empty()) return {};
  double mean = 0;
  for (const double x : tail.x) mean += std::log(x) / static_cast<double>(n);
  double sxx = 0, sxy = 0, variance = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(tail.y[i] > 2 * tail.error[i])) return {};
    const double dx = std::log(tail.x[i]) - mean, error = tail.error[i] / tail.y[i];
    sxx += dx * dx;
    sxy += dx * std::log(tail.y[i]);
    variance += dx * dx * error * error;
  }
  return {sxy / sxx, std::sqrt(variance) / sxx};
}

/// d ln Phi / d ln s over windows of half a decade, where it is known to 0.3.
std::optional<Curve> velocity_exponent(const StatePoint& point) {
  const auto curve = velocity_curve(point);
  if (!curve) return std::nullopt;
  return points_known(local_exponent(significant_part(*curve), std::sqrt(3.16)),
                      [](double, double error) { return error < 0.3; });
}

Figure tails(const Study& study) {
  constexpr double restitution = 0.7;
  Figure figure = paper_figure(2, "Velocity autocorrelation, ε = 0.7",
                               "Φ(s)/Φ(0) of the small disks up to where it is twice its error. Right: its local "
                               "exponent over half a decade, where known to 0.3; −1 (dotted) is a tail 1/s.",
                               collisions_axis, {"Φ(s) / Φ(0)", "", true},
                               "Long-time tails, close to 1/s: slower than exponential at all densities below the "
                               "onset of backscattering.");
  figure.alternative_x = lag_axis;
  const Family family = densities_at(study, restitution, Prefer::largest);
  add_family(figure, family, std::span(paper_densities).first(14), "velocity autocorrelation",
             [](const StatePoint& p) -> std::optional<Curve> {
               const auto curve = velocity_curve(p);
               return curve ? std::optional(significant_part(*curve)) : std::nullopt;
             });
  Figure panel = part_of(figure, "b", "Local exponent", collisions_axis, {"d ln Φ / d ln s", "", false});
  panel.alternative_x = lag_axis;
  add_family(panel, family, {}, "", velocity_exponent);
  panel.missing.clear();  // as in the first panel
  if (!panel.curves.empty()) {
    double last = 1;
    for (const Curve& curve : panel.curves) last = std::max(last, curve.x.back());
    panel.curves.push_back(guide("1/s", {panel.curves.front().x.front(), last}, {-1, -1}));
    figure.panels = {std::move(panel)};
  }
  Check check{
      "The tail is algebraic and close to 1/s for η ≤ 0.6: the exponent over 10 < s < 100 lies between −1.22 "
      "(1/(s √ln s) at s = 10) and −1",
      Outcome::not_enough_data, "It takes N ≥ 10 000 and a signal of two errors up to s = 100."};
  std::string inside, outside;
  for (const StatePoint* point : family.points) {
    const auto curve = velocity_curve(*point);
    if (!curve || point->packing_fraction() > 0.601 || point->config.system.particles < particles_for_tails) continue;
    const Measured exponent = tail_exponent(*curve);
    if (!std::isfinite(exponent.value)) continue;
    const double slack = significant_order * exponent.error;
    const bool fits = exponent.value > -1.22 - slack && exponent.value < -1 + slack;
    (fits ? inside : outside) +=
        fmt::format(" {} at η = {:g};", with_error(exponent.value, exponent.error), point->packing_fraction());
  }
  if (!inside.empty() || !outside.empty()) {
    check.outcome = outside.empty() ? Outcome::agrees : Outcome::differs;
    check.finding = "Exponents:" + outside + inside;
    check.finding.back() = '.';
  }
  figure.checks = {check};
  return figure;
}

/// Phi(s) times `factor`(s), for s > 1.
std::optional<Curve> multiplied(const StatePoint& point, double (*factor)(double)) {
  auto curve = velocity_curve(point);
  if (!curve) return std::nullopt;
  Curve part = between(significant_part(*curve), 1.2, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < part.x.size(); ++i) {
    part.y[i] *= factor(part.x[i]);
    if (!part.error.empty()) part.error[i] *= factor(part.x[i]);
  }
  return part;
}

/// Whether a multiplied tail is flat: its exponent is zero within the errors everywhere.
Check flatness(const Figure& figure, const Study& study, const std::string& what) {
  std::vector<NamedExponent> exponents;
  for (const Curve& curve : figure.curves) {
    const bool large = std::any_of(study.points.begin(), study.points.end(), [&](const StatePoint& p) {
      return same_level(p.restitution(), curve.level) && p.config.system.particles >= particles_for_tails;
    });
    const Measured exponent = tail_exponent(curve);
    if (large && std::isfinite(exponent.error)) exponents.push_back({curve.name, exponent});
  }
  return not_all_flat(what + " is not flat", "It takes N ≥ 10 000 and a signal of two errors up to s = 100.", exponents,
                      fmt::format("Exponents over {:g} < s < {:g}:", tail_from, tail_to));
}

Figure tail_shapes(const Study& study) {
  Figure figure = paper_figure(
      3, "Tail of the velocity autocorrelation times s",
      "Small disks; solid η = 0.5, dashed η = 0.4. If Φ ~ 1/s the left panel is flat, if "
      "Φ ~ 1/(s √ln s) the right one.",
      collisions_axis, {"s Φ(s) / Φ(0)", "", false},
      "At η = 0.4 and 0.5 (ε = 0.7, 0.8, 0.9) neither Φ s nor Φ s √ln s is flat over all times and densities.");
  Figure panel = part_of(figure, "b", "Times s √ln s", collisions_axis, {"s √(ln s) Φ(s) / Φ(0)", "", false});
  constexpr std::array<double, 3> restitutions{0.7, 0.8, 0.9};
  auto add = [&](Figure& target, double (*factor)(double)) {
    for (const double density : {0.5, 0.4}) {
      const std::size_t before = target.curves.size();
      Family family = restitutions_at(study, density, Prefer::largest);
      std::erase_if(family.points, [&](const StatePoint* p) {
        return std::none_of(restitutions.begin(), restitutions.end(),
                            [&](double e) { return same_level(e, p->restitution()); });
      });
      add_family(target, family, restitutions, "velocity autocorrelation",
                 [&](const StatePoint& p) { return multiplied(p, factor); });
      for (std::size_t i = before; i < target.curves.size(); ++i) {
        target.curves[i].line = density == 0.5 ? Line::solid : Line::dashed;
        target.curves[i].name += fmt::format(", η = {:g}", density);
      }
    }
  };
  add(figure, [](double s) { return s; });
  add(panel, [](double s) { return s * std::sqrt(std::log(s)); });
  figure.checks = {flatness(figure, study, "Φ s"), flatness(panel, study, "Φ s √ln s")};
  panel.missing.clear();  // as in the first panel
  figure.panels = {std::move(panel)};
  return figure;
}

/// The lowest value of a curve up to s = 50; what comes back from farther, lost in the noise, is not thrown back.
Measured lowest(const Curve& whole) {
  const Curve curve = between(whole, 0, 50);
  const auto at = std::min_element(curve.y.begin(), curve.y.end());
  if (at == curve.y.end() || curve.error.empty()) return {};
  return {*at, curve.error[static_cast<std::size_t>(at - curve.y.begin())]};
}

void zoom_to_zero(Figure& figure) {
  double deepest = 0, last = 1;
  for (const Curve& curve : figure.curves) {
    deepest = std::min(deepest, *std::min_element(curve.y.begin(), curve.y.end()));
    last = std::max(last, curve.x.back());
  }
  figure.y_range = {{1.3 * std::min(deepest, -0.02), 2.5 * std::max(-deepest, 0.02)}};
  figure.curves.push_back(guide("zero", {figure.curves.front().x.front(), last}, {0, 0}));
}

Figure backscattering(const Study& study) {
  Figure figure = paper_figure(4, "Backscattering",
                               "Φ(s)/Φ(0) of the small disks at η = 0.72 around zero: below it a disk has, on average, "
                               "been thrown back. Inset: denser systems at ε = 0.7.",
                               collisions_axis, {"Φ(s) / Φ(0)", "", false},
                               "At η = 0.72 the velocity autocorrelation turns negative only for the larger ε; the "
                               "negative range grows with η.");
  const auto make = [](const StatePoint& p) -> std::optional<Curve> {
    const auto curve = velocity_curve(p);
    return curve ? std::optional(between(*curve, 0.3, 200)) : std::nullopt;
  };
  add_family(figure, restitutions_at(study, 0.72), paper_restitutions, "velocity autocorrelation", make);
  Check sign{"At η = 0.72 Φ becomes negative at the largest ε and not at the smallest", Outcome::not_enough_data,
             "It takes at least two restitutions at η = 0.72, with errors."};
  std::vector<const Curve*> known;
  for (const Curve& curve : figure.curves)
    if (std::isfinite(lowest(curve).error)) known.push_back(&curve);
  if (known.size() > 1) {
    const Measured low = lowest(*known.front()), high = lowest(*known.back());
    const auto beyond = [](double depth, double error) { return depth > significant_extreme * error; };
    const bool deeper = beyond(low.value - high.value, standard_error_of_difference(low, high));
    if (beyond(-low.value, low.error) || (high.error < 0.002 && !beyond(-high.value, high.error)))
      sign.outcome = Outcome::differs;
    else if (beyond(-high.value, high.error) && deeper)
      sign.outcome = Outcome::agrees;
    sign.finding = fmt::format("The lowest value of Φ/Φ(0) is {} at ε = {:g} and {} at ε = {:g}.",
                               with_error(low.value, low.error), known.front()->level,
                               with_error(high.value, high.error), known.back()->level);
  }
  if (!figure.curves.empty()) zoom_to_zero(figure);

  Figure inset = part_of(figure, "_dense", "ε = 0.7", {"s", "", true}, {"Φ/Φ(0)", "", false});
  Family dense = densities_at(study, 0.7);
  std::erase_if(dense.points, [](const StatePoint* p) { return p->packing_fraction() < 0.719; });
  std::vector<Ranked> depth;
  for (const StatePoint* point : dense.points)
    if (const auto curve = make(*point)) depth.push_back({point->packing_fraction(), lowest(*curve)});
  std::erase_if(dense.points, [](const StatePoint* p) {
    return !same_level(p->packing_fraction(), 0.76) && !same_level(p->packing_fraction(), 0.78);
  });
  constexpr std::array<double, 2> wanted{0.76, 0.78};
  add_family(inset, dense, wanted, "velocity autocorrelation", make);
  if (!inset.curves.empty()) zoom_to_zero(inset);
  figure.insets = {std::move(inset)};
  figure.checks = {sign, falls("Backscattering grows with density: at ε = 0.7 the lowest value of Φ/Φ(0) falls with η",
                               depth, "The lowest value", "η")};
  return figure;
}

}  // namespace

void add_velocity_figures(const Study& study, std::vector<Figure>& figures) {
  for (Figure (*make)(const Study&) : {temperatures, tails, tail_shapes, backscattering})
    figures.push_back(make(study));
}

}  // namespace sandglass
