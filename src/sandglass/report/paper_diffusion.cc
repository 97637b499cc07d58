// Figures 8 to 10: diffusion in two dimensions, where it never quite sets in.
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

constexpr std::array<double, 3> tail_restitutions{0.7, 0.8, 0.9};
constexpr double reference_collisions = 1000;     // the paper's D is D(s = 1000)
constexpr std::uint64_t large = 250000;           // sound must not cross the box before s = 1000
constexpr double late_from = 100, late_to = 800;  // a derivative up to here needs lags up to s = 1000
const Axis diffusion_axis{"D(s) = ¼ dMSD/ds", "Rₛ²", true};

/// D(s) = (1/4) d MSD / ds of the small disks.
std::optional<Curve> diffusion(const StatePoint& point) {
  const auto msd = small_curve(point, "mean_square_displacement");
  if (!msd) return std::nullopt;
  Curve d = derivative(against_collisions(*msd));
  for (double& y : d.y) y /= 4;
  for (double& e : d.error) e /= 4;
  return d;
}

/// D(s) over `divisor`(s), from s = 3 on.
MakeCurve divided(double (*divisor)(double)) {
  return [divisor](const StatePoint& point) -> std::optional<Curve> {
    auto d = diffusion(point);
    if (!d) return std::nullopt;
    Curve part = between(*d, 3, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < part.x.size(); ++i) {
      part.y[i] /= divisor(part.x[i]);
      if (!part.error.empty()) part.error[i] /= divisor(part.x[i]);
    }
    return part;
  };
}

/// Exponents of a curve over late collisions per disk, at the points of large systems up to a density.
std::vector<NamedExponent> late_slopes(const Study& study, const MakeCurve& make, double highest_density) {
  std::vector<NamedExponent> slopes;
  for (const double restitution : tail_restitutions) {
    for (const StatePoint* point : densities_at(study, restitution, Prefer::largest).points) {
      if (point->config.system.particles < large || point->packing_fraction() > highest_density + 1e-4) continue;
      const auto curve = make(*point);
      if (!curve) continue;
      const Measured a = value_at(*curve, late_from), b = value_at(*curve, late_to);
      const Measured exponent{std::log(b.value / a.value) / std::log(late_to / late_from),
                              std::hypot(a.error / a.value, b.error / b.value) / std::log(late_to / late_from)};
      if (std::isfinite(exponent.error))
        slopes.push_back({fmt::format("η = {:g}, ε = {:g}", point->packing_fraction(), restitution), exponent});
    }
  }
  return slopes;
}

constexpr const char* needs_large = "It takes runs with N ≥ 250 000 that reach s = 1000 with errors.";

Figure growth(const Study& study) {
  Figure figure =
      paper_figure(8, "Diffusion coefficient against time", "Small disks, ε as in the title of each panel.",
                   collisions_axis, diffusion_axis, "D(s) keeps growing at large N (N = 4·10⁶; ε = 0.7, 0.8, 0.9).");
  std::vector<Figure> panels;
  for (const double restitution : tail_restitutions) {
    const Family family = densities_at(study, restitution, Prefer::largest);
    if (family.points.empty()) continue;
    Figure panel = part_of(figure, panels.empty() ? "" : std::string(1, static_cast<char>('a' + panels.size())),
                           fmt::format("ε = {:g}", restitution), figure.x, figure.y);
    add_family(panel, family, std::span(paper_densities).first(14), "mean square displacement", diffusion);
    panels.push_back(std::move(panel));
  }
  if (panels.empty()) {
    figure.missing = "This study has no runs at ε = 0.7, 0.8 or 0.9.";
  } else {
    figure.title += ", " + panels.front().title;
    figure.curves = std::move(panels.front().curves), figure.family = panels.front().family;
    figure.missing = panels.front().missing;
    figure.panels.assign(std::make_move_iterator(panels.begin() + 1), std::make_move_iterator(panels.end()));
  }
  Check check{"D grows from s = 100 to s = 800 (η ≤ 0.6)", Outcome::not_enough_data, needs_large};
  std::string grows, shrinks, unclear;
  for (const NamedExponent& slope : late_slopes(study, diffusion, 0.6)) {
    const std::string text =
        fmt::format(" {} ({});", with_error(slope.exponent.value, slope.exponent.error), slope.name);
    const double error = significant_order * slope.exponent.error;
    (slope.exponent.value > error ? grows : slope.exponent.value < -error ? shrinks : unclear) += text;
  }
  if (!grows.empty() || !shrinks.empty() || !unclear.empty()) {
    check.outcome = !shrinks.empty() ? Outcome::differs : grows.empty() ? Outcome::not_enough_data : Outcome::agrees;
    check.finding = "Exponents of D(s):" + grows + (shrinks.empty() ? "" : " falling:" + shrinks) +
                    (unclear.empty() ? "" : " zero within three errors:" + unclear);
    check.finding.back() = '.';
  }
  figure.checks = {check};
  return figure;
}

Figure logarithms(const Study& study) {
  const double restitution = shown_restitution(study, 0.7);
  Figure figure = paper_figure(9, fmt::format("D(s) over its expected logarithms, ε = {:g}", restitution),
                               "Flat on the left where D grows as ln s, on the right where it grows as √ln s.",
                               collisions_axis, {"D / ln s", "Rₛ²", true},
                               "Neither D/ln s (better at intermediate η) nor D/√ln s (better at high η) is flat over "
                               "all η.");
  Figure panel = part_of(figure, "b", "Over √ln s", collisions_axis, {"D / √(ln s)", "Rₛ²", true});
  const Family family = densities_at(study, restitution, Prefer::largest);
  const MakeCurve by_log = divided([](double s) { return std::log(s); });
  const MakeCurve by_root = divided([](double s) { return std::sqrt(std::log(s)); });
  add_family(figure, family, std::span(paper_densities).first(14), "mean square displacement", by_log);
  add_family(panel, family, {}, "mean square displacement", by_root);
  for (const auto& [make, name] : {std::pair(by_log, "D/ln s"), std::pair(by_root, "D/√ln s")}) {
    figure.checks.push_back(not_all_flat(fmt::format("{} is not flat over all densities (100 < s < 800)", name),
                                         needs_large, late_slopes(study, make, 1), "Exponents:"));
  }
  figure.panels = {std::move(panel)};
  return figure;
}

/// D of the small disks, per collision, by both methods, and the s where it was taken: as the runs measured it, with
/// errors over their intervals; without it, what the merged curves give.
struct Diffusion {
  Measured from_msd, from_vacf;
  double at = 0;
};

/// D(t) = (1/2) int <v(t').v(0)> dt' up to s = `at`, made a D per collision by the collision rate.
Measured green_kubo(const StatePoint& point, double at) {
  const auto running = small_curve(point, "running_diffusion");
  const double rate = point.number("collision_rate").value;
  if (!running) return {};
  const Measured d = value_at(*running, at / rate);
  return {d.value / rate, d.error / rate};
}

Diffusion diffusion_of(const StatePoint& point) {
  Diffusion d{point.number("diffusion/small/from_msd"), point.number("diffusion/small/from_vacf"),
              point.number("diffusion/small/at_collisions").value};
  if (std::isfinite(d.from_msd.value) && std::isfinite(d.at)) return d;
  const auto curve = diffusion(point);
  if (!curve || curve->x.empty()) return {};
  d.at = std::min(reference_collisions, curve->x.back());
  if (d.at < 30) return {};
  return {value_at(*curve, d.at), green_kubo(point, d.at), d.at};
}

Figure coefficients(const Study& study) {
  Figure figure = paper_figure(10, "Diffusion coefficient by two methods",
                               "Lines: D(s = 1000) from the MSD of the small disks. Marks without a line: half the "
                               "integral of ⟨v(t)·v(0)⟩, per collision, where it is known to a half. Then the second "
                               "over the first at the points that are compared.",
                               density_axis, {"D per collision", "Rₛ²", true},
                               "D falls by orders of magnitude towards η = 0.8, later for smaller ε; D(s = 1000) at "
                               "large N and the integral of the VACF at N = 10⁴ agree.");
  figure.family = restitution_axis;
  std::vector<Check> with_density, with_restitution;
  std::size_t compared = 0, equal = 0;
  double earliest = reference_collisions;
  std::string worst;
  double worst_ratio = 0;
  std::vector<Curve> integrals;
  Figure ratios = part_of(figure, "b", "VACF over MSD", density_axis, {"D (VACF) / D (MSD)", "", false});
  ratios.family = restitution_axis;
  for (const double restitution : restitutions_of(study)) {
    Curve slope{.name = fmt::format("ε = {:g}", restitution), .role = Role::family, .level = restitution};
    Curve area{.name = slope.name + ", VACF", .role = Role::family, .line = Line::points, .level = restitution};
    Curve ratio{.name = slope.name, .role = Role::family, .line = Line::points, .level = restitution};
    std::vector<Ranked> sequence;
    for (const StatePoint* point : densities_at(study, restitution, Prefer::largest).points) {
      const auto [d, g, at] = diffusion_of(*point);
      for (const auto& [curve, value] : {std::pair(&slope, d), std::pair(&area, g)}) {
        if (!(value.value > 0) || (curve == &area && value.error > value.value / 2)) continue;
        curve->x.push_back(point->packing_fraction());
        curve->y.push_back(value.value);
        curve->error.push_back(value.error);
      }
      if (std::isfinite(d.value)) earliest = std::min(earliest, at), sequence.push_back({point->packing_fraction(), d});
      const double error = standard_error_of_difference(d, g);
      const std::uint64_t intervals = point->config.run.intervals * point->replicas.size();
      if (!std::isfinite(error) || at < reference_collisions / 2 || intervals < 4) continue;  // no error from fewer
      ++compared;
      ratio.x.push_back(point->packing_fraction());
      ratio.y.push_back(g.value / d.value);
      ratio.error.push_back(error / d.value);
      const double allowed = std::max(significant_order * error, 0.1 * std::abs(d.value));
      if (std::abs(d.value - g.value) <= allowed) ++equal;
      if (std::abs(d.value - g.value) / allowed > worst_ratio) {
        worst_ratio = std::abs(d.value - g.value) / allowed;
        worst = fmt::format("at η = {:g}, ε = {:g}: {} and {}", point->packing_fraction(), restitution,
                            with_error(d.value, d.error), with_error(g.value, g.error));
      }
    }
    if (!slope.x.empty()) figure.curves.push_back(std::move(slope));
    if (!area.x.empty()) integrals.push_back(std::move(area));
    if (!ratio.x.empty()) ratios.curves.push_back(std::move(ratio));
    std::erase_if(sequence, [](const Ranked& r) { return r.argument < 0.4999; });
    with_density.push_back(falls("", sequence, fmt::format("At ε = {:g} D", restitution), "η"));
  }
  for (const double density : densities_of(study)) {
    if (density < 0.6999) continue;
    std::vector<Ranked> sequence;
    for (const StatePoint* point : restitutions_at(study, density, Prefer::largest).points)
      sequence.push_back({point->restitution(), diffusion_of(*point).from_msd});
    with_restitution.push_back(falls("", sequence, fmt::format("At η = {:g} D", density), "ε"));
  }
  Figure panel = part_of(figure, "c", "Lines of equal diffusivity", restitution_axis, density_axis);
  panel.family = {"D per collision", "Rₛ²", true};
  for (int p = 0; p >= -6; --p) {
    Curve line = iso_line(figure, std::pow(10, p), p == 0 ? "D = 1" : fmt::format("D = 10^{}", p));
    if (!line.x.empty()) panel.curves.push_back(std::move(line));
  }
  if (panel.curves.empty()) panel.missing = "No restitution of this study passes a power of ten between two densities.";
  if (figure.curves.empty())
    figure.missing = "Needed are runs whose intervals are longer than 1500 collisions per disk.";
  else if (earliest < reference_collisions)
    figure.missing =
        fmt::format("Some runs do not reach s = 1000: there D is taken at the longest lag, down to s = {}.",
                    short_number(earliest));
  figure.curves.insert(figure.curves.end(), integrals.begin(), integrals.end());
  if (!ratios.curves.empty()) {
    const std::vector<double> densities = densities_of(study);
    ratios.curves.push_back(guide("equal", {densities.front(), densities.back()}, {1, 1}));
    figure.panels.push_back(std::move(ratios));
  }
  figure.panels.push_back(std::move(panel));

  Check methods{"The two methods agree within three errors or 10 %", Outcome::not_enough_data,
                "Both are known up to s = 500, with errors over at least four intervals, at no point."};
  if (compared > 0) {
    methods.outcome = equal == compared ? Outcome::agrees : Outcome::differs;
    methods.finding = fmt::format("They agree at {} of {} points; farthest apart {}.", equal, compared, worst);
  }
  figure.checks = {joined("D falls with density (η ≥ 0.5)", with_density),
                   joined("D is larger for smaller ε (η ≥ 0.70)", with_restitution), methods};
  return figure;
}

}  // namespace

void add_diffusion_figures(const Study& study, std::vector<Figure>& figures) {
  for (Figure (*make)(const Study&) : {growth, logarithms, coefficients}) figures.push_back(make(study));
}

}  // namespace sandglass
