// Figures 23 and 24: momentum and energy, as the drive brings them and the collisions take them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sandglass/report/number.h"
#include "sandglass/report/paper_figures.h"
#include "sandglass/report/point_family.h"
#include "sandglass/study/results.h"
#include "sandglass/theory/equation_of_state.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

/// The correlation length where it is known to a half, and not an end of the range in which it was looked for.
Measured correlation_length(const StatePoint& point) {
  const Measured length = point.number("velocity_correlation_length");
  const double longest = point.replicas.front().summary.box_length / (2 * std::numbers::pi);
  const bool known = length.error < length.value / 2 && length.value > 1.05 && length.value < 0.95 * longest;
  return known ? length : Measured{};
}

Figure velocity_structure(const Study& study) {
  const double restitution = shown_restitution(study, 0.7);
  Figure figure = paper_figure(23, fmt::format("Transverse velocity structure factor, ε = {:g}", restitution),
                               "⟨|J_k|²⟩/Σm of the momentum across the wave vector; then along it, and the correlation "
                               "length of the first where it is known to a half. In elastic equilibrium both are T at "
                               "every k (dotted).",
                               {"k", "1/Rₛ", true}, {"S_v(k)", "T₀", false});
  constexpr std::array<double, 4> chosen{0.1, 0.5, 0.65, 0.78};
  const Family family = few_of(densities_at(study, restitution, Prefer::largest), chosen);
  const auto add = [&](Figure& target, const char* part) {
    add_family(target, family, {}, part, [part](const StatePoint& p) {
      return plain_curve(p, fmt::format("/structure/velocity/{}", part), "wavenumber", "value", "error");
    });
    if (target.curves.empty()) return;
    const std::vector<double>& k = target.curves.front().x;
    target.curves.push_back(guide("T", {k.front(), k.back()}, {1, 1}));
  };
  add(figure, "transverse");
  Figure along = part_of(figure, "b", "Longitudinal", figure.x, figure.y);
  add(along, "longitudinal");
  Figure panel = part_of(figure, "c", "Correlation length", density_axis, {"ξ", "Rₛ", false});
  panel.family = restitution_axis;
  panel.curves = against_density(study, correlation_length);
  for (Curve& curve : panel.curves) curve.line = Line::points;
  for (Figure* part : {&along, &panel})
    if (!part->curves.empty()) figure.panels.push_back(std::move(*part));
  return figure;
}

/// Energy that the kicks bring, against what the collisions take: equal in a steady state but for what is stored.
Check balance_check(const Study& study) {
  Check check{"Energy injected equals energy dissipated, within 0.1 %, and with the stored one to rounding",
              Outcome::not_enough_data, "There are no driven runs."};
  double worst = 0, worst_balance = 0;
  std::size_t points = 0;
  std::string where;
  for (const StatePoint& point : study.points) {
    const double injected = point.number("energy/injected").value, dissipated = point.number("energy/dissipated").value;
    const double difference = std::abs(injected - dissipated) / injected;
    if (!std::isfinite(difference)) continue;
    ++points;
    worst_balance = std::max(worst_balance, std::abs(point.number("energy/balance").value));
    if (difference < worst) continue;
    worst = difference;
    where = fmt::format("η = {:g}, ε = {:g}", point.packing_fraction(), point.restitution());
  }
  if (points == 0) return check;
  check.outcome = worst < 1e-3 && worst_balance < 1e-9 ? Outcome::agrees : Outcome::differs;
  check.finding = fmt::format(
      "At {} state point{} they differ by at most {:.2g} ({}); with the kinetic energy stored "
      "the balance closes to {:.2g}.",
      points, points == 1 ? "" : "s", worst, where, worst_balance);
  return check;
}

/// Z of the elastic fluid, up to where its theory holds.
Curve elastic_fluid(const Config& config) {
  Curve curve = guide("elastic fluid", {}, {});
  const double ratio = config.system.size_ratio;
  const Mixture mixture{{1, ratio}, {1, ratio * ratio}};
  for (double density = 0.1; density < 0.655; density += 0.05) {
    curve.x.push_back(density);
    curve.y.push_back(fluid_compressibility_factor(mixture, config.system.big_fraction, density));
  }
  return curve;
}

Figure thermodynamics(const Study& study) {
  Figure figure = paper_figure(24, "Energy, pressure and collisions",
                               "Energy per disk and time that the kicks bring (lines) and the collisions take (marks). "
                               "Then the compressibility factor (dotted: theory of the elastic fluid), and the rate at "
                               "which a disk collides with those of a species, over the mean rate of all.",
                               density_axis, {"energy flow", "T₀ √(T₀/mₛ)/Rₛ", true});
  figure.family = restitution_axis;
  const auto flow = [](const char* which) {
    return [which](const StatePoint& p) -> Measured {
      const Measured energy = p.number(std::string("energy/") + which);
      const double time = p.number("time").value;
      return {energy.value / time, energy.error / time};
    };
  };
  figure.curves = against_density(study, flow("injected"));
  for (Curve& curve : against_density(study, flow("dissipated"))) {
    curve.name += ", dissipated", curve.line = Line::points;
    figure.curves.push_back(std::move(curve));
  }
  Figure pressure = part_of(figure, "b", "Pressure", density_axis, {"Z = pV/(NT)", "", true});
  pressure.family = restitution_axis;
  pressure.curves = against_density(study, [](const StatePoint& p) { return p.number("compressibility_factor"); });
  if (!pressure.curves.empty()) pressure.curves.push_back(elastic_fluid(study.points.front().config));
  const double restitution = shown_restitution(study, 0.9);
  Figure rates = part_of(figure, "c", fmt::format("Collision rates by pair, ε = {:g}", restitution), density_axis,
                         {"ω_ij / ω", "", false});
  for (const auto& [pair, name, role] :
       {std::tuple("small_small", "small with small", Role::small),
        std::tuple("small_big", "small with big", Role::all), std::tuple("big_big", "big with big", Role::big)}) {
    Curve curve{.name = name, .role = role};
    for (const StatePoint* point : densities_at(study, restitution).points) {
      const Measured rate = point->number(fmt::format("collision_rate_by_pair/{}", pair)),
                     all = point->number("collision_rate");
      if (!std::isfinite(rate.value)) continue;
      curve.x.push_back(point->packing_fraction());
      curve.y.push_back(rate.value / all.value);
      curve.error.push_back(rate.error / all.value);
    }
    rates.curves.push_back(std::move(curve));
  }
  for (Figure* panel : {&pressure, &rates})
    if (!panel->curves.empty() && !panel->curves.front().x.empty()) figure.panels.push_back(std::move(*panel));
  figure.checks = {balance_check(study)};
  return figure;
}

}  // namespace

void add_flow_figures(const Study& study, std::vector<Figure>& figures) {
  for (Figure (*make)(const Study&) : {velocity_structure, thermodynamics}) figures.push_back(make(study));
}

}  // namespace sandglass
