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

/// How far one side of a peak, from its foot to its top, is from being a single slope: between two steeper parts of the
/// climb, the least slope over that of the less steep part. 1 for a plain peak, 0 for a level shoulder, negative for a
/// dip: two peaks. Slopes are taken over `reach` to both sides.
Measured levelling(const Curve& climb) {
  constexpr double reach = 0.2;
  const std::size_t n = climb.x.size();
  if (n < 3) return {};
  const double bin = std::abs(climb.x[1] - climb.x[0]);
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(reach / bin)));
  std::vector<Measured> slope;
  for (std::size_t i = half; i + half < n; ++i) {
    const double width = std::abs(climb.x[i + half] - climb.x[i - half]);
    slope.push_back({(climb.y[i + half] - climb.y[i - half]) / width,
                     std::hypot(climb.error[i + half], climb.error[i - half]) / width});
  }
  Measured least{1, 0};
  const auto flatter = [](const Measured& a, const Measured& b) { return a.value < b.value; };
  for (std::size_t i = 1; i + 1 < slope.size(); ++i) {
    const auto here = slope.begin() + static_cast<std::ptrdiff_t>(i);
    const Measured before = *std::max_element(slope.begin(), here, flatter),
                   after = *std::max_element(here + 1, slope.end(), flatter), side = std::min(before, after, flatter);
    const double ratio = here->value / side.value;
    if (side.value > 0 && ratio < least.value)
      least = {ratio, std::hypot(here->error, ratio * side.error) / side.value};
  }
  return least;
}

/// The second peak reaches from the first minimum, behind the contact distance, to two disks with a big one between
/// them in a straight line; of its two sides the one that is less of a single slope.
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
  const Measured left = levelling(between(peak, first, top)), right = levelling(fall);
  return left.value <= right.value || !std::isfinite(right.value) ? left : right;
}

double contact_of(const StatePoint& point, const std::string& pair) {
  return pair == "small_small" ? 2 : 2 * point.config.system.size_ratio;
}

/// The distance of two disks of the pair with a big one between them in a straight line.
double across_of(const StatePoint& point, const std::string& pair) {
  return contact_of(point, pair) + 2 * point.config.system.size_ratio;
}

/// The density at which `splitting` sinks below a half for good, held against the paper's.
Check split_check(const Family& family, const std::string& pair) {
  constexpr Measured paper{0.55, 0.02};  // read off figures at 0.5, 0.55, 0.6: about half a step
  constexpr double too_noisy = 0.25;
  Check check{
      "The second peak begins to split at η = 0.55(2): the slope between its two parts is half of that before and "
      "after",
      Outcome::not_enough_data, "It takes g(r) with errors, in bins below 0.3 Rₛ, at densities on both sides."};
  std::vector<Ranked> known;
  double two_peaks = INFINITY;
  for (const StatePoint* point : family.points) {
    const auto curve = radial(*point, pair);
    const Measured ratio = curve ? splitting(*curve, contact_of(*point, pair), across_of(*point, pair)) : Measured{};
    if (point->packing_fraction() < 0.45 || !(ratio.error < too_noisy)) continue;
    known.push_back({point->packing_fraction(), ratio});
    if (ratio.value < -significant_extreme * ratio.error) two_peaks = std::min(two_peaks, known.back().argument);
  }
  const auto after = std::find_if(known.rbegin(), known.rend(), [](const Ranked& r) { return r.value.value >= 0.5; });
  if (after == known.rend() || after == known.rbegin()) return check;
  const Ranked &whole = *after, &split = *(after - 1);
  const double fall = whole.value.value - split.value.value, per_density = (split.argument - whole.argument) / fall,
               part = (whole.value.value - 0.5) / fall;
  const Measured found{whole.argument + part * (split.argument - whole.argument),
                       per_density * std::hypot((1 - part) * whole.value.error, part * split.value.error)};
  check = compare(check.claim, found, paper, fmt::format("between η = {:g} and {:g}", whole.argument, split.argument));
  if (std::isfinite(two_peaks))
    check.finding += fmt::format(" There are two separate maxima from η = {:g} on.", two_peaks);
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
  const auto whole = [&](const StatePoint& p) -> std::optional<Curve> {
    const auto curve = radial(p, pair);
    return curve ? std::optional(between(*curve, 1.5, 12)) : std::nullopt;
  };
  const auto second_peak = [&](const StatePoint& p) -> std::optional<Curve> {
    const auto curve = radial(p, pair);
    const double across = across_of(p, pair);
    return curve ? std::optional(between(*curve, across - 1.9, across + 2.1)) : std::nullopt;
  };
  const Family shown = few_of(family, structure_densities);
  add_family(figure, shown, structure_densities, "g(r)", whole);
  Figure panel = part_of(figure, "b", "The second peak", figure.x, figure.y);
  add_family(panel, shown, {}, "g(r)", second_peak);
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
