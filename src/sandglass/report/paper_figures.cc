#include "sandglass/report/paper_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/point_family.h"

namespace sandglass {
namespace {

void tidy(Figure& figure) {
  std::erase_if(figure.curves, [](const Curve& curve) { return curve.y.empty(); });
  if (figure.empty() && figure.missing.empty()) figure.missing = "There are no data for this figure.";
  for (Figure& part : figure.panels) tidy(part);
  for (Figure& part : figure.insets) tidy(part);
}

/// A number of the summaries against density.
Figure overview(const Study& study, std::string id, std::string title, std::string caption, Axis y,
                const Number& number) {
  Figure figure{.id = std::move(id), .title = std::move(title), .caption = std::move(caption), .x = density_axis};
  figure.y = std::move(y);
  figure.family = restitution_axis;
  figure.curves = against_density(study, number);
  if (figure.curves.empty()) figure.missing = "Not measured in these runs.";
  return figure;
}

}  // namespace

std::vector<Figure> paper_figures(const Study& study) {
  std::vector<Figure> figures;
  add_velocity_figures(study, figures);
  add_displacement_figures(study, figures);
  add_scattering_figures(study, figures);
  add_diffusion_figures(study, figures);
  add_structure_figures(study, figures);
  add_mobility_figures(study, figures);
  add_flow_figures(study, figures);
  std::stable_sort(figures.begin(), figures.end(), [](const Figure& a, const Figure& b) { return a.id < b.id; });
  for (Figure& figure : figures) tidy(figure);
  return figures;
}

std::vector<Figure> overview_figures(const Study& study) {
  const auto number = [](const char* path) { return [path](const StatePoint& p) { return p.number(path); }; };
  const auto ratio = [](const StatePoint& p) -> Measured {
    const Measured small = p.number("temperature/small"), big = p.number("temperature/big");
    const double value = small.value / big.value;
    return {value, value * std::hypot(small.error / small.value, big.error / big.value)};
  };
  std::vector<Figure> figures{
      overview(study, "overview_rate", "Collision rate", "Collisions per disk and time.",
               {"collision rate ω", "√(T₀/mₛ) / Rₛ", true}, number("collision_rate")),
      overview(study, "overview_pressure", "Pressure", "From the virial of the collisions.",
               {"compressibility factor Z", "", true}, number("compressibility_factor")),
      overview(study, "overview_temperature", "Temperature of small over big disks",
               "Equipartition, T_s = T_b, does not hold in a driven granular fluid.", {"T_s / T_b", "", false}, ratio),
      overview(study, "overview_exponent", "Exponent of the mean square displacement",
               "Fitted to the small disks over 1 < t < 10: 1 is diffusion, less a cage.", {"exponent", "", false},
               number("msd_exponent/small/value"))};
  for (Figure& figure : figures) tidy(figure);
  return figures;
}

}  // namespace sandglass
