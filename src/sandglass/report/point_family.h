// State points of a study as the figures need them: all densities at one restitution, or the reverse.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sandglass/report/curve_math.h"
#include "sandglass/report/figure_data.h"
#include "sandglass/study/collect.h"

namespace sandglass {

/// The grid of the paper.
inline constexpr std::array<double, 10> paper_restitutions{0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95};
inline constexpr std::array<double, 17> paper_densities{0.1,  0.2,  0.3,  0.4,  0.5,  0.6,  0.65, 0.7, 0.72,
                                                        0.74, 0.75, 0.76, 0.77, 0.78, 0.79, 0.8,  0.81};

/// Where several points share density and restitution (another size, another drive): which one is shown.
enum class Prefer : std::uint8_t { longest, largest };

/// Points along one line of the (density, restitution) plane.
struct Family {
  std::vector<const StatePoint*> points;  ///< by the parameter that varies
  bool by_density = true;                 ///< else by restitution
  double fixed = 0;                       ///< the other one
  Prefer prefer = Prefer::longest;

  [[nodiscard]] double level(const StatePoint& p) const { return by_density ? p.packing_fraction() : p.restitution(); }
  [[nodiscard]] const char* symbol() const { return by_density ? "η" : "ε"; }
};
Family densities_at(const Study& study, double restitution, Prefer prefer = Prefer::longest);
Family restitutions_at(const Study& study, double density, Prefer prefer = Prefer::longest);

/// The points of the family nearest to the levels `chosen`, where these are at least three; else all.
Family few_of(Family family, std::span<const double> chosen);

/// Those that occur in the study, ascending.
std::vector<double> restitutions_of(const Study& study);
std::vector<double> densities_of(const Study& study);
bool same_level(double a, double b);

/// The restitution that a figure at one restitution shows: `wanted` if the study has it, else the one with the most
/// densities.
double shown_restitution(const Study& study, double wanted);

/// The point at (density, restitution), or the nearest one; which is shown is said in the figure's title, and in
/// `missing` if it is not the wanted one. Null if no point `has` the data.
const StatePoint* shown_point(const Study& study, double density, double restitution, Figure& figure,
                              const std::function<bool(const StatePoint&)>& has);
bool is_point(const StatePoint* point, double density, double restitution);

using MakeCurve = std::function<std::optional<Curve>(const StatePoint&)>;

/// One curve for each point of the family that has it. `wanted` are the levels of the paper; what lacks is said in
/// `missing`: runs, or in the runs that are there the measurement (`quantity`, in words).
void add_family(Figure& figure, const Family& family, std::span<const double> wanted, const std::string& quantity,
                const MakeCurve& make);

/// What a function of the lag of the small disks is, with collisions as the second x axis.
std::optional<Curve> small_curve(const StatePoint& point, const std::string& quantity);
/// A row of it, for the wavenumber nearest to `wavenumber` (within a tenth).
std::optional<Curve> small_curve(const StatePoint& point, const std::string& quantity, double wavenumber);
/// A measured function of one argument: datasets `x`, `y`, `error` of a group of the results.
std::optional<Curve> plain_curve(const StatePoint& point, const std::string& group, const std::string& x,
                                 const std::string& y, const std::string& error);
/// The same curve with collisions per disk as x and time as the second axis.
Curve against_collisions(Curve curve);

using Number = std::function<Measured(const StatePoint&)>;

/// A number of the state points against density, where it is known: a curve for each restitution of the study.
std::vector<Curve> against_density(const Study& study, const Number& number);

/// The points of a curve as a sequence that may rise or fall.
std::vector<Ranked> ranked(const Curve& curve);

/// A numbered figure with nothing in it yet. Ids are "fig01" and so on. One beyond the paper has no statement.
Figure paper_figure(int number, std::string title, std::string caption, Axis x, Axis y, std::string statement = {});

/// A part of it: panel or inset.
Figure part_of(const Figure& whole, const std::string& suffix, std::string title, Axis x, Axis y);

inline const Axis lag_axis{"lag t", "Rₛ √(mₛ/T₀)", true};
inline const Axis collisions_axis{"collisions per disk s", "", true};
inline const Axis density_axis{"packing fraction η", "", false};
inline const Axis restitution_axis{"restitution ε", "", false};

/// Where the curves of `figure` (a quantity against density, one for each restitution) pass `level`: density against
/// restitution.
Curve iso_line(const Figure& figure, double level, std::string name);

/// A dotted line through the given points.
Curve guide(std::string name, std::vector<double> x, std::vector<double> y);

/// "0.7, 0.75".
std::string listed(std::span<const double> values);

}  // namespace sandglass
