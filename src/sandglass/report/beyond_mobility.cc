// Figures 18 to 22: how differently the disks move, and how that changes with age.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sandglass/report/number.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/point_family.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

constexpr double caged = 0.6999;  // densities from which the paper sees cages

/// Few densities, from the fluid to the glass.
Family shown_densities(const Study& study) {
  constexpr std::array<double, 6> chosen{0.5, 0.65, 0.72, 0.76, 0.79, 0.81};
  return few_of(densities_at(study, shown_restitution(study, 0.9)), chosen);
}

/// One lag of G_s as a curve against r, times `factor`(r); rings with fewer than ten displacements are left out.
template <class Factor>
Curve displacements_at(const StatePoint& point, std::size_t lag, Factor&& factor) {
  const std::string group = "/dynamics/small/van_hove/";
  const auto read = [&](const char* name) { return numbers_of(point.results, group + name); };
  const auto time = read("time"), r = read("r"), value = read("value"), error = read("error"), count = read("count");
  Curve curve{.name = fmt::format("t = {}", short_number(time[lag])), .role = Role::family, .level = time[lag]};
  for (std::size_t bin = 0, i = lag * r.size(); bin < r.size() && i < value.size(); ++bin, ++i) {
    if (!(value[i] > 0) || (i < count.size() && count[i] < 10)) continue;
    curve.x.push_back(r[bin]);
    curve.y.push_back(factor(r[bin]) * value[i]);
    if (error.size() == value.size()) curve.error.push_back(factor(r[bin]) * error[i]);
  }
  return curve;
}

Figure van_hove(const Study& study) {
  Figure figure = paper_figure(
      18, "How far the disks have gone",
      "Small disks: distribution of ln r of the displacements r, 2πr²G_s(r, t). Where displacements are Gaussian it "
      "has "
      "one shape at all times, as high as the dotted line (2/e). Right: the self van Hove function itself, t > 0.1.",
      {"displacement r", "Rₛ", true}, {"2πr² G_s(r, t)", "", false});
  const StatePoint* point = shown_point(study, 0.8, 0.9, figure, [](const StatePoint& p) {
    return find_dataset(p.results, "/dynamics/small/van_hove/value") != nullptr;
  });
  if (point == nullptr) return figure;
  figure.family = {"lag t", "Rₛ √(mₛ/T₀)", true};
  Figure panel =
      part_of(figure, "b", "Self van Hove function", {"displacement r", "Rₛ", false}, {"G_s(r, t)", "Rₛ⁻²", true});
  panel.family = figure.family;
  const auto lags = numbers_of(point->results, "/dynamics/small/van_hove/time");
  double first = INFINITY, last = 0;
  for (std::size_t lag = 0; lag < lags.size(); ++lag) {
    Curve curve = displacements_at(*point, lag, [](double r) { return 2 * std::numbers::pi * r * r; });
    if (curve.x.empty()) continue;
    first = std::min(first, curve.x.front()), last = std::max(last, curve.x.back());
    figure.curves.push_back(std::move(curve));
    if (lags[lag] > 0.1) panel.curves.push_back(displacements_at(*point, lag, [](double) { return 1.0; }));
  }
  if (figure.curves.empty()) return figure;
  const double gaussian = 2 / std::numbers::e;
  figure.curves.push_back(guide("Gaussian", {first, last}, {gaussian, gaussian}));
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  return figure;
}

/// The highest point of a curve, if the curve comes down again behind it.
Measured peak(const Curve& curve) {
  const auto top = std::max_element(curve.y.begin(), curve.y.end());
  if (top == curve.y.end() || curve.error.empty()) return {};
  const Measured highest{*top, curve.error[static_cast<std::size_t>(top - curve.y.begin())]};
  const Measured last{curve.y.back(), curve.error.back()};
  const bool passed = highest.value - last.value > significant_order * standard_error_of_difference(highest, last);
  return passed ? highest : Measured{};
}

Check peak_grows(const Family& family, const std::string& quantity, const std::string& symbol) {
  std::vector<Ranked> peaks;
  for (const StatePoint* point : family.points) {
    const auto curve = small_curve(*point, quantity), moved = small_curve(*point, "mean_square_displacement");
    const bool free = moved && !moved->y.empty() && moved->y.back() > 1;  // else what rattles has a peak of its own
    if (curve && free && point->packing_fraction() > caged) peaks.push_back({point->packing_fraction(), peak(*curve)});
  }
  return rises("The peak of " + symbol + " grows with η (η ≥ 0.70, where disks get away by their radius)", peaks,
               "The peak of " + symbol, "η");
}

Figure non_gaussian(const Study& study) {
  const Family all = densities_at(study, shown_restitution(study, 0.9));
  Figure figure = paper_figure(19, fmt::format("Non-Gaussian parameter, ε = {:g}", all.fixed),
                               "α₂ = ⟨Δr⁴⟩/(2⟨Δr²⟩²) − 1 of the small disks: 0 where displacements are Gaussian.",
                               lag_axis, {"α₂(t)", "", false});
  figure.alternative_x = collisions_axis;
  add_family(figure, shown_densities(study), {}, "α₂",
             [](const StatePoint& p) { return small_curve(p, "non_gaussian"); });
  figure.checks = {peak_grows(all, "non_gaussian", "α₂")};
  return figure;
}

Figure overlap(const Study& study) {
  const Family all = densities_at(study, shown_restitution(study, 0.9)), family = shown_densities(study);
  Figure figure =
      paper_figure(20, fmt::format("Overlap and its fluctuations, ε = {:g}", all.fixed),
                   "Q(t), the part of the small disks that are within 0.6 Rₛ (observe.overlap_length) of "
                   "where they were. Right: χ₄ = N(⟨Q²⟩ − ⟨Q⟩²), how many move together, where it exceeds its "
                   "error.",
                   lag_axis, {"Q(t)", "", false});
  figure.alternative_x = collisions_axis;
  add_family(figure, family, {}, "Q(t)", [](const StatePoint& p) { return small_curve(p, "overlap"); });
  Figure panel = part_of(figure, "b", "Dynamic susceptibility", lag_axis, {"χ₄(t)", "", true});
  panel.alternative_x = collisions_axis;
  add_family(panel, family, {}, "χ₄", [](const StatePoint& p) {
    auto curve = small_curve(p, "susceptibility");  // before anything moves it is nothing: a long way down
    if (curve) curve = points_known(*curve, [](double y, double error) { return y > 0.01 && error < y; });
    return curve;
  });
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  figure.checks = {peak_grows(all, "susceptibility", "χ₄")};
  return figure;
}

/// The cage-relative MSD over the MSD.
std::optional<Curve> relative_to_cage(const StatePoint& point) {
  const auto whole = small_curve(point, "mean_square_displacement");
  auto ratio = small_curve(point, "cage_relative_displacement");
  if (!whole || !ratio) return std::nullopt;
  for (std::size_t i = 0; i < ratio->x.size(); ++i) {
    const Measured below = value_at(*whole, ratio->x[i]);
    const double relative_error =
        std::hypot(ratio->error.empty() ? 0 : ratio->error[i] / ratio->y[i], below.error / below.value);
    ratio->y[i] /= below.value;
    if (!ratio->error.empty()) ratio->error[i] = ratio->y[i] * relative_error;
  }
  return points_where(*ratio, [](double, double y) { return std::isfinite(y); });
}

/// d ln y / d ln x between x = 1 and 10.
Measured exponent_to_ten(const std::optional<Curve>& curve) {
  if (!curve) return {};
  const Measured a = value_at(*curve, 1), b = value_at(*curve, 10);
  return {std::log10(b.value / a.value), std::hypot(a.error / a.value, b.error / b.value) / std::log(10)};
}

Check collective_check(const Family& family) {
  Check check{"Neighbours move along: in the cage (η ≥ 0.70) the cage-relative MSD falls below the MSD",
              Outcome::not_enough_data, "It was not measured at η ≥ 0.70."};
  std::string below, not_below;
  for (const StatePoint* point : family.points) {
    const auto ratio = relative_to_cage(*point);
    if (!ratio || point->packing_fraction() < caged || ratio->y.empty() || ratio->error.empty()) continue;
    const auto lowest = std::min_element(ratio->y.begin(), ratio->y.end());
    const double error = ratio->error[static_cast<std::size_t>(lowest - ratio->y.begin())];
    (*lowest < 1 - significant_extreme * error ? below : not_below) +=
        fmt::format(" {} at η = {:g};", with_error(*lowest, error), point->packing_fraction());
  }
  if (below.empty() && not_below.empty()) return check;
  check.outcome = not_below.empty() ? Outcome::agrees : below.empty() ? Outcome::differs : Outcome::not_enough_data;
  check.finding = "Smallest ratio of the two:" + below + not_below;
  check.finding.back() = '.';
  for (const StatePoint* point : family.points) {
    if (!same_level(point->packing_fraction(), 0.81)) continue;
    const Measured whole = exponent_to_ten(small_curve(*point, "mean_square_displacement")),
                   relative = exponent_to_ten(small_curve(*point, "cage_relative_displacement"));
    if (std::isfinite(whole.value) && std::isfinite(relative.value))
      check.finding += fmt::format(" From t = 1 to 10 at η = 0.81 the MSD grows with exponent {}, cage-relative {}.",
                                   with_error(whole.value, whole.error), with_error(relative.value, relative.error));
  }
  return check;
}

Figure cage_relative(const Study& study) {
  const Family all = densities_at(study, shown_restitution(study, 0.9)), family = shown_densities(study);
  Figure figure = paper_figure(21, fmt::format("Displacement relative to the cage, ε = {:g}", all.fixed),
                               "Small disks: MSD (solid) and the mean square of the displacement minus the mean one of "
                               "the neighbours (dashed), which the long waves of a two-dimensional system do not "
                               "inflate. Right: their ratio; neighbours independent of the disk make it more than 1.",
                               lag_axis, {"MSD ⟨Δr²⟩", "Rₛ²", true});
  figure.alternative_x = collisions_axis;
  add_family(figure, family, {}, "MSD", [](const StatePoint& p) { return small_curve(p, "mean_square_displacement"); });
  add_family(figure, family, {}, "cage-relative MSD", [](const StatePoint& p) {
    auto curve = small_curve(p, "cage_relative_displacement");
    if (curve) curve->name = fmt::format("η = {:g}, relative", p.packing_fraction()), curve->line = Line::dashed;
    return curve;
  });
  Figure panel = part_of(figure, "b", "Relative to the cage, over the MSD", lag_axis, {"ratio", "", false});
  panel.alternative_x = collisions_axis;
  add_family(panel, family, {}, "cage-relative MSD", relative_to_cage);
  if (!panel.curves.empty()) {
    panel.curves.push_back(guide("one", {panel.curves.back().x.front(), panel.curves.back().x.back()}, {1, 1}));
    figure.panels = {std::move(panel)};
  }
  figure.checks = {collective_check(all)};
  return figure;
}

/// The MSD of each interval of a point, with its waiting time as level.
std::vector<Curve> aged_displacements(const StatePoint& point) {
  const std::string group = "/dynamics/small/mean_square_displacement/";
  const auto waiting = numbers_of(point.results, "/dynamics/waiting_time"),
             time = numbers_of(point.results, group + "time"),
             values = numbers_of(point.results, group + "interval_value"),
             errors = numbers_of(point.results, group + "interval_error");
  std::vector<Curve> curves;
  if (waiting.size() < 2 || values.size() != waiting.size() * time.size()) return curves;
  for (std::size_t interval = 0; interval < waiting.size(); ++interval) {
    Curve curve{.name = fmt::format("t_w = {}", short_number(waiting[interval])),
                .role = Role::family,
                .level = waiting[interval]};
    for (std::size_t lag = 0; lag < time.size(); ++lag) {
      const std::size_t i = interval * time.size() + lag;
      if (!(values[i] > 0)) continue;
      curve.x.push_back(time[lag]);
      curve.y.push_back(values[i]);
      if (errors.size() == values.size()) curve.error.push_back(errors[i]);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

Figure ageing(const Study& study) {
  constexpr double lag = 10;
  Figure figure = paper_figure(22, "Ageing",
                               "MSD of the small disks in each interval of the run by itself; t_w is the time from the "
                               "start of the measurement to the middle of the interval. Right: MSD at t = 10 in each "
                               "interval over its mean. An interval of one run has no error: its scatter is seen "
                               "between the intervals.",
                               lag_axis, {"MSD ⟨Δr²⟩", "Rₛ²", true});
  const auto has = [](const StatePoint& p) { return !aged_displacements(p).empty(); };
  const StatePoint* point = shown_point(study, 0.81, 0.9, figure, has);
  if (point == nullptr) return figure;
  figure.family = {"waiting time t_w", "Rₛ √(mₛ/T₀)", false};
  constexpr std::size_t most = 6;
  const auto all = aged_displacements(*point);
  for (std::size_t i = 0; i < std::min(most, all.size()); ++i)
    figure.curves.push_back(all[all.size() <= most ? i : i * (all.size() - 1) / (most - 1)]);
  Figure panel = part_of(figure, "b", fmt::format("MSD(t = {:g}) against waiting time", lag),
                         {"waiting time t_w", "Rₛ √(mₛ/T₀)", true}, {"MSD over its mean", "", false});
  Family family = densities_at(study, point->restitution());
  std::erase_if(family.points, [](const StatePoint* p) { return p->packing_fraction() < 0.7699; });
  add_family(panel, family, {}, "intervals", [&](const StatePoint& p) -> std::optional<Curve> {
    Curve curve{.name = ""};
    double mean = 0;
    for (const Curve& aged : aged_displacements(p)) {
      const Measured value = value_at(aged, lag);
      if (!std::isfinite(value.value)) return std::nullopt;
      curve.x.push_back(aged.level), curve.y.push_back(value.value), mean += value.value;
      if (std::isfinite(value.error)) curve.error.push_back(value.error);
    }
    mean /= static_cast<double>(curve.y.size());
    for (auto* column : {&curve.y, &curve.error})
      for (double& v : *column) v /= mean;
    return curve;
  });
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

void add_mobility_figures(const Study& study, std::vector<Figure>& figures) {
  for (Figure (*make)(const Study&) : {van_hove, non_gaussian, overlap, cage_relative, ageing})
    figures.push_back(make(study));
}

}  // namespace sandglass
