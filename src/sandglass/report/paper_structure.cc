// Figures 14 to 17: where the disks are.
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

constexpr std::array<double, 6> structure_densities{0.5, 0.52, 0.55, 0.58, 0.6, 0.8};

std::optional<Curve> radial(const StatePoint& point, const std::string& pair) {
  return plain_curve(point, "/structure/radial_distribution", "r", pair, pair + "_error");
}

/// One side of a peak, from its foot to its top, where it is split or begins to be: between two steeper parts of the
/// climb its slope sinks below half of the less steep one (below zero in a dip). The greatest such difference, in
/// slopes over `reach` to both sides.
Measured shoulder(const Curve& climb) {
  constexpr double reach = 0.2;
  std::vector<Measured> slope;
  const std::size_t n = climb.x.size();
  if (n < 3) return {};
  const double bin = std::abs(climb.x[1] - climb.x[0]);
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(reach / bin)));
  for (std::size_t i = half; i + half < n; ++i) {
    const double width = std::abs(climb.x[i + half] - climb.x[i - half]);
    slope.push_back({(climb.y[i + half] - climb.y[i - half]) / width,
                     std::hypot(climb.error[i + half], climb.error[i - half]) / width});
  }
  Measured deepest;
  const auto flatter = [](const Measured& a, const Measured& b) { return a.value < b.value; };
  for (auto here = slope.begin(); here < slope.end(); ++here) {
    if (here == slope.begin() || here + 1 == slope.end()) continue;
    const Measured before = *std::max_element(slope.begin(), here, flatter),
                   after = *std::max_element(here + 1, slope.end(), flatter), side = std::min(before, after, flatter);
    const double depth = side.value / 2 - here->value;
    if (!(depth <= deepest.value)) deepest = {depth, std::hypot(side.error / 2, here->error)};
  }
  return deepest;
}

/// The second peak reaches from the first minimum, behind the contact distance, to two disks with a big one between
/// them in a straight line; the shoulder of that side which has the clearer one.
Measured splitting(const Curve& curve, double contact, double across) {
  const Curve valley = between(curve, 1.2 * contact, 2 * contact);
  const auto lowest = std::min_element(valley.y.begin(), valley.y.end());
  if (lowest == valley.y.end()) return {};
  const double first = valley.x[static_cast<std::size_t>(lowest - valley.y.begin())];
  const Curve peak = between(curve, first, 1.08 * across);
  if (peak.x.size() < 5 || peak.error.empty()) return {};
  const auto highest = std::max_element(peak.y.begin(), peak.y.end());
  const double top = peak.x[static_cast<std::size_t>(highest - peak.y.begin())];
  Curve fall = between(peak, top, 2 * across);
  for (auto* column : {&fall.x, &fall.y, &fall.error}) std::reverse(column->begin(), column->end());
  const Measured left = shoulder(between(peak, first, top)), right = shoulder(fall);
  const auto clarity = [](const Measured& m) { return std::isfinite(m.error) ? m.value / m.error : -INFINITY; };
  return clarity(left) < clarity(right) ? right : left;
}

Check split_check(const Family& family, const std::string& pair) {
  Check check{"The second peak is split, by a dip or a shoulder, at η ≥ 0.58 and not at η ≤ 0.52",
              Outcome::not_enough_data, "It takes g(r) with errors, in bins below 0.3 Rₛ, on both sides of 0.55."};
  std::string split, whole, unclear;
  bool below = false, above = false, wrong = false;
  for (const StatePoint* point : family.points) {
    const auto curve = radial(*point, pair);
    const double density = point->packing_fraction();
    if (!curve || density < 0.45) continue;
    const double big = point->config.system.size_ratio, contact = pair == "small_small" ? 2 : 2 * big;
    const Measured depth = splitting(*curve, contact, contact + 2 * big);
    if (!std::isfinite(depth.error)) continue;
    const bool is_split = depth.value > significant_extreme * depth.error;
    if (!is_split && significant_extreme * depth.error > 0.2) {
      unclear += fmt::format(" {:g}", density);
      continue;
    }
    (is_split ? split : whole) += fmt::format(" {:g}", density);
    if (density < 0.5201) below = true, wrong = wrong || is_split;
    if (density > 0.5799) above = true, wrong = wrong || !is_split;
  }
  if (!unclear.empty()) check.finding = fmt::format("Errors are too large to tell at η ={}.", unclear);
  if (split.empty() && whole.empty()) return check;
  check.finding = fmt::format("Split at η ={}; one peak at η ={}{}{}.", split.empty() ? " none" : split,
                              whole.empty() ? " none" : whole,
                              unclear.empty() ? "" : "; errors are too large to tell at η =", unclear);
  if (wrong)
    check.outcome = Outcome::differs;
  else if (below && above)
    check.outcome = Outcome::agrees;
  return check;
}

Figure radial_figure(const Study& study, int number, const std::string& pair, const std::string& symbol,
                     const std::string& disks) {
  const double restitution = shown_restitution(study, 0.9);
  Figure figure = paper_figure(number, fmt::format("Pair correlation of the {} disks, ε = {:g}", disks, restitution),
                               fmt::format("{}(r) against density; 1 where positions are independent.", symbol),
                               {"distance r", "Rₛ", false}, {symbol + "(r)", "", false},
                               "The second peak splits near η = 0.55, more strongly for the big disks.");
  const Family family = densities_at(study, restitution, Prefer::largest);
  const auto part = [&](double from, double to) {
    return [&pair, from, to](const StatePoint& p) -> std::optional<Curve> {
      const auto curve = radial(p, pair);
      return curve ? std::optional(between(*curve, from, to)) : std::nullopt;
    };
  };
  const Family shown = few_of(family, structure_densities);
  add_family(figure, shown, structure_densities, "g(r)", part(1.5, 12));
  Figure panel = part_of(figure, "b", "The second peak", figure.x, figure.y);
  add_family(panel, shown, {}, "g(r)", part(3, 7));
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  figure.checks = {split_check(family, pair)};
  return figure;
}

/// S(k) at k = spacing (m - M, n - M) from map[m, n], M the middle. The mode (M, M), which holds N, is left out.
std::optional<HeatMap> scattering_map(const StatePoint& point) {
  const std::string group = "/structure/structure_factor/small/";
  const Dataset* data = find_dataset(point.results, group + "map");
  const auto values = numbers_of(point.results, group + "map"), spacing = numbers_of(point.results, group + "spacing");
  if (data == nullptr || spacing.empty() || data->shape.size() != 2 || data->shape[0] != data->shape[1] ||
      data->shape[0] % 2 == 0)
    return std::nullopt;
  const std::size_t side = data->shape[0], middle = side / 2;
  HeatMap map;
  map.x0 = map.y0 = -static_cast<double>(middle) * spacing.front();
  map.dx = map.dy = spacing.front();
  map.columns = map.rows = side;
  map.scale = {"S(k)", "", true};
  map.values.resize(side * side);
  for (std::size_t m = 0; m < side; ++m)
    for (std::size_t n = 0; n < side; ++n) map.values[n * side + m] = values[m * side + n];
  map.values[middle * side + middle] = Measured{}.value;
  return map;
}

Figure structure_map(const Study& study) {
  Figure figure = paper_figure(
      16, "Structure factor of the small disks",
      "S(k) in the plane of wave vectors, averaged over frames. Inset: its average over rings.", {"k_x", "1/Rₛ", false},
      {"k_y", "1/Rₛ", false}, "Isotropic rings: no crystalline order (η = 0.80 in the text, 0.81 in the caption).");
  const StatePoint* point =
      shown_point(study, 0.81, 0.9, figure, [](const StatePoint& p) { return scattering_map(p).has_value(); });
  Check check{"S(k) is isotropic: the sixfold anisotropy of the ring of the main peak is below 0.1, beyond its noise",
              Outcome::not_enough_data, "It was not measured at η ≥ 0.80."};
  if (point != nullptr) {
    figure.map = scattering_map(*point);
    const std::string ring = "/structure/structure_factor/small/ring";
    auto curve = plain_curve(*point, ring, "wavenumber", "value", "error");
    const auto anisotropy = numbers_of(point->results, ring + "/anisotropy");
    if (curve) {
      const auto count = numbers_of(point->results, ring + "/count");
      std::size_t peak = 0;  // beyond k = 2, where the composition does not fluctuate
      for (std::size_t i = 0; i < curve->x.size(); ++i)
        if (curve->x[i] > 2 && (curve->x[peak] <= 2 || curve->y[i] > curve->y[peak])) peak = i;
      if (point->packing_fraction() > 0.7999 && peak < anisotropy.size() && count.size() == anisotropy.size()) {
        const double noise = 1 / std::sqrt(count[peak]), bound = 0.1 + 2 * noise;
        if (bound < 0.4) check.outcome = anisotropy[peak] < bound ? Outcome::agrees : Outcome::differs;
        check.finding = fmt::format("It is {:.2g} at k = {:.3g}, with noise of about {:.2g} (1 for six sharp spots).",
                                    anisotropy[peak], curve->x[peak], noise);
      }
      Figure inset = part_of(figure, "_ring", "Ring average", {"k", "1/Rₛ", false}, {"S(k)", "", false});
      curve->name = "S(k)", curve->role = Role::small;
      inset.curves = {std::move(*curve)};
      figure.insets = {std::move(inset)};
    }
  }
  figure.checks = {check};
  return figure;
}

Figure bond_order(const Study& study) {
  const double restitution = shown_restitution(study, 0.9);
  Figure figure = paper_figure(
      17, "Sixfold bond order", "ψ₆ of the whole system against density (all disks). Right: its correlation g₆(r).",
      density_axis, {"ψ₆", "", false}, "No long-range bond order: the dense states are glasses, not crystals.");
  figure.family = restitution_axis;
  figure.curves = against_density(study, [](const StatePoint& p) -> Measured {
    const auto value = numbers_of(p.results, "/structure/bond_order/global");
    const auto error = numbers_of(p.results, "/structure/bond_order/global_error");
    return {value.empty() ? Measured{}.value : value.front(), error.empty() ? Measured{}.error : error.front()};
  });
  if (figure.curves.empty()) figure.missing = "Not measured in these runs: /structure/bond_order.";
  Figure panel = part_of(figure, "b", fmt::format("Correlation of the bond order, ε = {:g}", restitution),
                         {"distance r", "Rₛ", false}, {"g₆(r)", "", false});
  const auto correlation = [](const StatePoint& p) {
    return plain_curve(p, "/structure/bond_order/correlation", "r", "value", "error");
  };
  const Family family = densities_at(study, restitution, Prefer::largest);
  add_family(panel, few_of(family, std::array{0.3, 0.5, 0.65, 0.72, 0.78, 0.81}), {}, "g₆(r)",
             [&](const StatePoint& p) -> std::optional<Curve> {
               const auto curve = correlation(p);
               return curve ? std::optional(between(*curve, 0, 40)) : std::nullopt;
             });
  Check check{"No long-range order at η ≥ 0.78: beyond 15 Rₛ |g₆| stays below 0.1", Outcome::not_enough_data,
              "g₆(r) beyond 15 Rₛ was not measured at η ≥ 0.78."};
  for (const StatePoint* point : family.points) {
    const auto curve = correlation(*point);
    const double density = point->packing_fraction();
    if (!curve || density < 0.7799) continue;
    const Curve far = between(*curve, 15, std::numeric_limits<double>::infinity());
    if (far.y.empty()) continue;
    double mean = 0;
    for (const double y : far.y) mean += y / static_cast<double>(far.y.size());
    check.outcome = std::abs(mean) < 0.1 && check.outcome != Outcome::differs ? Outcome::agrees : Outcome::differs;
    check.finding = fmt::format("The mean of g₆ beyond 15 Rₛ is {} at η = {:g}.", short_number(mean), density);
    if (check.outcome == Outcome::differs) break;
  }
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  figure.checks = {check};
  return figure;
}

}  // namespace

void add_structure_figures(const Study& study, std::vector<Figure>& figures) {
  figures.push_back(radial_figure(study, 14, "small_small", "g_ss", "small"));
  figures.push_back(radial_figure(study, 15, "big_big", "g_bb", "big"));
  figures.push_back(structure_map(study));
  figures.push_back(bond_order(study));
}

}  // namespace sandglass
