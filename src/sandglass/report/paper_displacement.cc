// Figures 5 to 7 and 13: how far disks move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sandglass/report/correlation.h"
#include "sandglass/report/number.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/point_family.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

const Axis displacement_axis{"MSD ⟨Δr²⟩", "Rₛ²", true};

std::optional<Curve> displacement(const StatePoint& point) { return small_curve(point, "mean_square_displacement"); }

/// The smallest local exponent of the MSD, over windows of half a decade.
Measured smallest_exponent(const StatePoint& point) {
  const auto msd = displacement(point);
  if (!msd) return {};
  const Curve slope = local_exponent(*msd, std::sqrt(3.16));
  const auto at = std::min_element(slope.y.begin(), slope.y.end());
  if (at == slope.y.end() || slope.error.empty()) return {};
  return {*at, slope.error[static_cast<std::size_t>(at - slope.y.begin())]};
}

/// Whether the smallest local exponent is below 1: the smallest of many is low by chance.
bool is_caged(const Measured& smallest) { return smallest.value < 1 - significant_extreme * smallest.error; }

Check cages(const Family& family) {
  Check check{"A cage for η ≥ 0.70: the smallest local exponent is below 1", Outcome::not_enough_data,
              "There are no runs at η ≥ 0.70."};
  std::string caged, free, unclear;
  for (const StatePoint* point : family.points) {
    const Measured exponent = smallest_exponent(*point);
    if (point->packing_fraction() < 0.6999 || !std::isfinite(exponent.error)) continue;
    // That the smallest of many is above 1 says more than that it is below.
    std::string& list = is_caged(exponent)                                        ? caged
                        : exponent.value > 1 + significant_order * exponent.error ? free
                                                                                  : unclear;
    list += fmt::format(" {} at η = {:g};", with_error(exponent.value, exponent.error), point->packing_fraction());
  }
  if (caged.empty() && free.empty() && unclear.empty()) return check;
  check.outcome = !free.empty() ? Outcome::differs : caged.empty() ? Outcome::not_enough_data : Outcome::agrees;
  check.finding.clear();
  for (const auto& [words, points] :
       {std::pair{"No cage:", &free}, {"Not clear:", &unclear}, {"A cage, with smallest exponent:", &caged}}) {
    if (points->empty()) continue;
    points->back() = '.';
    check.finding += (check.finding.empty() ? "" : " ") + (words + *points);
  }
  return check;
}

Check diffusion_regained(const Family& family) {
  Check check{"Diffusion is regained at long times for η = 0.70 to 0.77", Outcome::not_enough_data,
              "There are no runs at these densities."};
  std::string diffusive, slower;
  bool any_caged = false;
  for (const StatePoint* point : family.points) {
    const double density = point->packing_fraction();
    const auto msd = displacement(*point);
    if (density < 0.6999 || density > 0.7701 || !msd) continue;
    const Curve slope = local_exponent(*msd);
    if (slope.y.empty() || slope.error.empty()) continue;
    any_caged = any_caged || is_caged(smallest_exponent(*point));
    const Measured last{slope.y.back(), slope.error.back()};
    const bool regained = last.value > 0.9 && msd->y.back() > 1;
    (regained ? diffusive : slower) += fmt::format(" {} at η = {:g};", with_error(last.value, last.error), density);
  }
  if (diffusive.empty() && slower.empty()) return check;
  if (!any_caged) {
    check.finding = "None of the runs at these densities shows a cage from which diffusion could be regained.";
    return check;
  }
  check.outcome = slower.empty() ? Outcome::agrees : Outcome::not_enough_data;
  check.finding = slower.empty() ? "Last local exponents:" + diffusive
                                 : "Not yet above 0.9 beyond MSD = 1, so these runs are too short:" + slower;
  check.finding.back() = '.';
  return check;
}

/// What stands behind the numbers of a point.
std::string described(const StatePoint& point) {
  const std::size_t runs = point.replicas.size();
  const auto ageing = std::count_if(point.replicas.begin(), point.replicas.end(),
                                    [](const Replica& replica) { return !replica.summary.stationary; });
  std::string text =
      fmt::format("with N = {}, {} start{} and {} collisions per disk in all", point.config.system.particles, runs,
                  runs == 1 ? "" : "s", short_number(point.length()));
  if (ageing > 0) text += fmt::format(" ({} not stationary)", ageing);
  return text;
}

Check exponent_check(const Family& family, const Measured& paper) {
  const std::string claim = fmt::format("At η = 0.81 MSD ~ t^{} over 1 < t < 10", with_error(paper.value, paper.error));
  for (const StatePoint* point : family.points) {
    if (!same_level(point->packing_fraction(), 0.81)) continue;
    const auto msd = displacement(*point);
    const bool covered = msd && msd->x.back() > 9;
    const std::string where = described(*point);
    return compare(claim, covered ? point->number("msd_exponent/small/value") : Measured{}, paper,
                   covered ? where : "up to t = 10 at η = 0.81");
  }
  return {claim, Outcome::not_enough_data, "There is no run at η = 0.81."};
}

Figure displacements(const Study& study, int number, double restitution, const Measured& paper) {
  Figure figure = paper_figure(
      number, fmt::format("Mean square displacement, ε = {:g}", restitution),
      "Small disks. Inset: the local exponent d ln MSD / d ln t; 2 is free flight, 1 diffusion, less a cage.", lag_axis,
      displacement_axis,
      fmt::format("A cage appears for η ≥ 0.70, diffusion is regained at long times up to η = 0.77. At η = 0.81 the "
                  "exponent over 1 < t < 10 is {}.",
                  with_error(paper.value, paper.error)));
  figure.alternative_x = collisions_axis;
  const Family family = densities_at(study, restitution);
  add_family(figure, family, paper_densities, "mean square displacement", displacement);
  Figure inset = part_of(figure, "_exponent", "Local exponent", {"t", "", true}, {"exponent", "", false});
  inset.family = figure.family;
  for (const Curve& curve : figure.curves) {
    Curve slope = local_exponent(curve);
    slope.error.clear();
    slope.alternative_x.clear();
    inset.curves.push_back(std::move(slope));
  }
  if (!inset.curves.empty()) {
    inset.y_range = {{0, 2.1}};
    figure.insets = {std::move(inset)};
  }
  figure.checks = {exponent_check(family, paper), cages(family), diffusion_regained(family)};
  return figure;
}

/// t(MSD_s = 1) of a point.
Measured unit_time(const StatePoint& point) {
  const auto msd = displacement(point);
  return msd ? crossing(*msd, 1) : Measured{};
}

Figure unit_times(const Study& study) {
  Figure figure = paper_figure(7, "Time to move by one radius", "t at which the MSD of the small disks is Rₛ².",
                               density_axis, {"t(MSD = 1)", "Rₛ √(mₛ/T₀)", true},
                               "t(MSD = 1) grows with η, the more so the more elastic the disks; the lines "
                               "t = 3, 5, 8 in the (η, ε) plane fall monotonically with ε.");
  figure.family = restitution_axis;
  std::vector<double> lacking(paper_restitutions.begin(), paper_restitutions.end());
  std::vector<Check> with_density, with_restitution, lines;
  figure.curves = against_density(study, unit_time);
  for (const Curve& curve : figure.curves)
    with_density.push_back(rises("", ranked(curve), fmt::format("At ε = {:g} t(MSD = 1)", curve.level), "η"));
  for (const double restitution : restitutions_of(study))
    std::erase_if(lacking, [&](double e) { return same_level(e, restitution); });
  if (!lacking.empty()) figure.missing = fmt::format("Not in this study: ε = {}.", listed(lacking));
  if (figure.curves.empty()) figure.missing += " No run reaches MSD = 1.";
  for (const double density : densities_of(study)) {
    if (density < 0.6999) continue;
    std::vector<Ranked> sequence;
    for (const StatePoint* point : restitutions_at(study, density).points)
      sequence.push_back({point->restitution(), unit_time(*point)});
    with_restitution.push_back(rises("", sequence, fmt::format("At η = {:g} t(MSD = 1)", density), "ε"));
  }
  Figure panel = part_of(figure, "b", "Lines of equal t(MSD = 1)", restitution_axis, density_axis);
  panel.family = {"t(MSD = 1)", "", false};
  for (const double time : {3.0, 5.0, 8.0}) {
    Curve line = iso_line(figure, time, fmt::format("t = {:g}", time));
    lines.push_back(falls("", ranked(line), fmt::format("On t = {:g} η", time), "ε"));
    if (!line.x.empty()) panel.curves.push_back(std::move(line));
  }
  if (panel.curves.empty()) panel.missing = "No restitution of this study passes t = 3, 5 or 8 between two densities.";
  figure.panels = {std::move(panel)};
  figure.checks = {joined("t(MSD = 1) grows with η", with_density),
                   joined("t(MSD = 1) grows with ε (η ≥ 0.70)", with_restitution),
                   joined("The lines t = 3, 5, 8 fall with ε", lines)};
  return figure;
}

/// A curve of the fast or the slow disks at the lag at which they were told apart, the nearest to the time asked for;
/// it has a cusp there, across which nothing can be interpolated.
std::pair<double, Measured> at_selection(const Curve& curve, double asked) {
  const auto nearer = [&](double a, double b) { return std::abs(std::log(a / asked)) < std::abs(std::log(b / asked)); };
  const auto lag = std::min_element(curve.x.begin(), curve.x.end(), nearer);
  return {*lag, value_at(curve, *lag)};
}

Figure mobilities(const Study& study) {
  Figure figure = paper_figure(13, "Fast and slow disks",
                               "MSD of the tenth of all disks that moves farthest, and least, within the selection "
                               "time; dashed: of the small disks.",
                               lag_axis, displacement_axis,
                               "At η = 0.8, ε = 0.9 the slowest tenth (by displacement at t = 10³) is immobile, the "
                               "fastest diffuses over several radii.");
  figure.alternative_x = collisions_axis;
  const std::string place = "/dynamics/small/mobility/fastest/value";
  const StatePoint* point = shown_point(study, 0.8, 0.9, figure,
                                        [&](const StatePoint& p) { return find_dataset(p.results, place) != nullptr; });
  Check fast{"The fastest tenth moves over several radii: MSD > 4 Rₛ² at t = 10³", Outcome::not_enough_data, ""};
  Check slow{"The slowest tenth is immobile: MSD < 0.1 Rₛ² at t = 10³", Outcome::not_enough_data, ""};
  fast.finding = slow.finding = "There is no run at η = 0.8, ε = 0.9 that measures it.";
  if (point == nullptr) {
    figure.checks = {fast, slow};
    return figure;
  }
  const auto whole = displacement(*point);
  if (whole) {
    figure.curves.push_back(*whole);
    figure.curves.back().name = "small disks", figure.curves.back().role = Role::all;
  }
  // By default disks are told apart by the whole interval, which is the longest lag.
  const double configured = point->config.observe.selection_time;
  const double selected = configured > 0 ? configured : whole ? whole->x.back() : 0;
  figure.caption += fmt::format(" Selection time {}.", short_number(selected));
  const bool papers_time = std::abs(std::log(selected / 1000)) < std::log(1.2);
  for (const auto& [speed, role] : {std::pair("fastest", Role::big), std::pair("slowest", Role::small)}) {
    const std::string quantity = fmt::format("mobility/{}", speed);
    std::string missing;
    if (const auto all = correlation(point->results, "all", quantity, missing))
      figure.curves.push_back(curve_of(*all, fmt::format("{} tenth", speed), role));
    auto curve = small_curve(*point, quantity);
    if (!curve || curve->x.empty()) continue;
    curve->name = fmt::format("{} of the small", speed), curve->role = role, curve->line = Line::dashed;
    figure.curves.push_back(*curve);
    if (!is_point(point, 0.8, 0.9)) continue;
    Check& check = role == Role::big ? fast : slow;
    if (!papers_time) {
      check.finding = fmt::format("The tenths are those of t = {}: it takes observe.selection_time = 1000.",
                                  short_number(selected));
      continue;
    }
    const auto [time, far] = at_selection(*curve, 1000);
    check.finding = fmt::format("The MSD at t = {}, where they were told apart, is {} Rₛ².", short_number(time),
                                with_error(far.value, far.error));
    if (!std::isfinite(far.error)) continue;
    const double excess = (far.value - (role == Role::big ? 4 : 0.1)) * (role == Role::big ? 1 : -1);
    if (std::abs(excess) > significant * far.error) check.outcome = excess > 0 ? Outcome::agrees : Outcome::differs;
  }
  figure.checks = {fast, slow};
  return figure;
}

}  // namespace

void add_displacement_figures(const Study& study, std::vector<Figure>& figures) {
  figures.push_back(displacements(study, 5, 0.9, {0.547, 0.006}));
  figures.push_back(displacements(study, 6, 0.7, {0.6163, 0.0011}));
  for (Figure (*make)(const Study&) : {unit_times, mobilities}) figures.push_back(make(study));
}

}  // namespace sandglass
