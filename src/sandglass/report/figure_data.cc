#include "sandglass/report/figure_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "sandglass/report/correlation.h"
#include "sandglass/report/curve_math.h"
#include "sandglass/report/number.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

struct Kind {
  const char* name;
  Role role;
};
constexpr std::array<Kind, 3> kinds{{{"small", Role::small}, {"big", Role::big}, {"all", Role::all}}};

/// The curve x -> function(x) over the points of `like` with first <= x <= last.
template <class Function>
Curve along(const Curve& like, double first, double last, Function function) {
  Curve curve;
  for (std::size_t i = 0; i < like.x.size(); ++i) {
    if (like.x[i] < first || like.x[i] > last) continue;
    curve.x.push_back(like.x[i]);
    curve.y.push_back(function(like.x[i]));
    if (!like.alternative_x.empty()) curve.alternative_x.push_back(like.alternative_x[i]);
  }
  return curve;
}

Figure lag_figure(std::string id, std::string title, std::string caption, Axis y) {
  return {.id = std::move(id),
          .title = std::move(title),
          .caption = std::move(caption),
          .x = {"lag t", "Rₛ √(mₛ/T₀)", true},
          .alternative_x = {"collisions per disk s", "", true},
          .y = std::move(y)};
}

/// Slopes 2 (free flight) and 1 (diffusion) beside the ends of the curve, each over one and a half decades.
void add_guides(Figure& figure, const Curve& curve) {
  constexpr double stretch = 31.6, offset = 2.5;
  double first = 0;
  for (const double x : curve.x) {
    if (x > 0) {
      first = x;
      break;
    }
  }
  if (first <= 0 || curve.x.back() < first * stretch) return;
  const double last = curve.x.back();
  auto guide = [&](const char* name, double slope, double from, double to, double x0, double y0) {
    Curve line = along(curve, from, to, [&](double x) { return y0 * std::pow(x / x0, slope); });
    line.name = name, line.role = Role::guide, line.line = Line::dotted;
    figure.curves.push_back(std::move(line));
  };
  const auto at = static_cast<std::size_t>(std::find(curve.x.begin(), curve.x.end(), first) - curve.x.begin());
  guide("slope 2, free flight", 2, first, first * stretch, first, offset * curve.y[at]);
  guide("slope 1, diffusion", 1, last / stretch, last, last, curve.y.back() / offset);
}

/// The power law t^exponent of the summary through the centre of gravity of ln MSD against ln t in its range.
void add_fit(Figure& figure, const Curve& measured, const Summary::Exponent& exponent) {
  Curve line = along(measured, exponent.from, exponent.to, [](double) { return 0.0; });
  if (!std::isfinite(exponent.value) || line.x.empty()) {
    figure.caption += "No exponent was fitted: the curve does not cover the range.";
    return;
  }
  double mean = 0;
  for (std::size_t i = 0; i < measured.x.size(); ++i) {
    if (measured.x[i] < exponent.from || measured.x[i] > exponent.to) continue;
    mean += std::log(measured.y[i]) - exponent.value * std::log(measured.x[i]);
  }
  mean /= static_cast<double>(line.x.size());
  for (std::size_t i = 0; i < line.x.size(); ++i) line.y[i] = std::exp(mean + exponent.value * std::log(line.x[i]));
  line.name = fmt::format("fit: exponent {}", with_error(exponent.value, exponent.error));
  line.role = Role::fit;
  figure.caption += fmt::format("The thick line is the power law t^{} fitted to the {} disks in {:g} < t < {:g}.",
                                with_error(exponent.value, exponent.error), measured.name, exponent.from, exponent.to);
  if (measured.x.back() < 0.9 * exponent.to)
    figure.caption += fmt::format(" The run covers this range only up to t = {:.3g}.", measured.x.back());
  figure.curves.push_back(std::move(line));
}

Figure displacement_figure(const Results& results, const Summary& summary) {
  Figure figure = lag_figure("msd", "Mean square displacement", "", {"MSD ⟨Δr²⟩", "Rₛ²", true});
  figure.caption =
      "How far a disk gets in a time t: free flight at short times, a cage of neighbours where the curve "
      "flattens, diffusion when the cage has opened. ";
  for (const Kind& kind : kinds) {
    const auto c = correlation(results, kind.name, "mean_square_displacement", figure.missing);
    if (c) figure.curves.push_back(curve_of(*c, kind.name, kind.role));
  }
  if (figure.curves.empty()) return figure;
  const Curve measured = figure.curves.front();
  add_fit(figure, measured, measured.role == Role::big ? summary.msd_exponent.big : summary.msd_exponent.small);
  add_guides(figure, measured);
  return figure;
}

/// Phi(t) / Phi(0), and its negative part on its own scale where there is one beyond the error.
void add_velocity_figures(const Results& results, std::vector<Figure>& figures) {
  Figure figure = lag_figure("vacf", "Velocity autocorrelation",
                             "How much of its velocity a disk still has after a time t. Below zero it has, on "
                             "average, been thrown back by its neighbours.",
                             {"Φ(t) / Φ(0)", "", false});
  double lowest = 0;
  for (const Kind& kind : kinds) {
    const auto c = correlation(results, kind.name, "velocity_autocorrelation", figure.missing);
    if (!c) continue;
    const auto at_zero =
        numbers_of(results, fmt::format("/dynamics/{}/velocity_autocorrelation/equal_time_value", kind.name));
    if (at_zero.empty() || !(at_zero.front() > 0)) {
      figure.missing += fmt::format("The results hold no Φ(0) for {}. ", kind.name);
      continue;
    }
    Curve curve = curve_of(*c, kind.name, kind.role, 0, at_zero.front());
    for (std::size_t i = 0; i < curve.y.size(); ++i) {
      const double error = curve.error.empty() || !std::isfinite(curve.error[i]) ? 0 : curve.error[i];
      if (curve.y[i] + 3 * error < 0) lowest = std::min(lowest, curve.y[i]);
    }
    figure.curves.push_back(std::move(curve));
  }
  figures.push_back(figure);
  if (lowest >= 0) return;
  figure.id = "vacf_negative";
  figure.title = "Velocity autocorrelation, negative part";
  figure.caption = fmt::format("The same curves on a finer scale: the lowest value is {:.3g}.", lowest);
  figure.y_range = {{1.25 * lowest, -0.75 * lowest}};
  Curve zero = along(figure.curves.front(), 0, figure.curves.front().x.back(), [](double) { return 0.0; });
  zero.name = "zero", zero.role = Role::guide, zero.line = Line::dotted;
  figure.curves.push_back(std::move(zero));
  figures.push_back(std::move(figure));
}

/// S_inc(k, t) with its Gaussian approximation, <exp(-k^2 <dr^2> / 4)> over the wave vectors, a figure for each k.
void add_scattering_figures(const Results& results, std::vector<Figure>& figures) {
  const std::string title = "Incoherent scattering function";
  const Figure blank = lag_figure("scattering", title, "", {"S_inc(k, t)", "", false});
  const auto wavenumbers = numbers_of(results, "/dynamics/all/self_intermediate_scattering/wavenumber");
  if (wavenumbers.empty()) {
    figures.push_back(blank);
    figures.back().missing = "The results hold no /dynamics/all/self_intermediate_scattering with its wavenumbers.";
  }
  for (std::size_t k = 0; k < wavenumbers.size(); ++k) {
    Figure figure = blank;
    figure.id = fmt::format("scattering_{}", k);
    figure.parameter = wavenumbers[k];
    figure.title = fmt::format("{}, k = {:.3g} / Rₛ", title, wavenumbers[k]);
    figure.caption = fmt::format(
        "The memory of positions on the length 2π/k = {:.3g} Rₛ; at 0 it is lost. Dashed: the Gaussian approximation "
        "exp(−k²⟨Δr²⟩/4), which holds where all disks move alike.",
        2 * std::numbers::pi / wavenumbers[k]);
    auto add = [&](const Kind& kind, const char* quantity, const char* suffix, Line line) {
      const auto c = correlation(results, kind.name, quantity, figure.missing, wavenumbers.size());
      if (!c) return;
      figure.curves.push_back(curve_of(*c, kind.name, kind.role, k));
      figure.curves.back().name += suffix;
      figure.curves.back().line = line;
    };
    for (const Kind& kind : kinds) add(kind, "self_intermediate_scattering", "", Line::solid);
    for (const Kind& kind : kinds) add(kind, "gaussian_approximation", ", Gaussian", Line::dashed);
    figures.push_back(std::move(figure));
  }
}

/// What is recorded from t = 0 on: the temperatures, their ratio, and the collisions per disk.
void add_history_figures(const Results& results, std::vector<Figure>& figures) {
  const std::vector<double> time = numbers_of(results, "/timeseries/time");
  const std::vector<double> collisions = numbers_of(results, "/timeseries/collisions");
  Figure blank = lag_figure("", "", "", {});
  blank.x.label = "time t since the start";
  auto history = [&](const std::string& path, const Kind& kind, Figure& figure) {
    Curve curve{.name = kind.name,
                .role = kind.role,
                .x = time,
                .y = numbers_of(results, path),
                .alternative_x = collisions.size() == time.size() ? collisions : std::vector<double>{}};
    if (curve.y.empty() || curve.y.size() != time.size())
      figure.missing += fmt::format("The results hold no {} that fits /timeseries/time. ", path);
    else
      figure.curves.push_back(std::move(curve));
  };

  Figure temperature = blank;
  temperature.id = "temperature", temperature.title = "Temperatures";
  temperature.caption =
      "Mean kinetic energy per disk, from the Gaussian start at T = T₀ through equilibration to the "
      "end of the run.";
  temperature.y = {"temperature T", "T₀", false};
  for (const Kind& kind : kinds) history(fmt::format("/timeseries/temperature_{}", kind.name), kind, temperature);

  Figure ratio = blank;
  ratio.id = "temperature_ratio", ratio.title = "Temperature of small over big disks";
  ratio.caption = "Equipartition, T_s = T_b, does not hold in a driven granular fluid.";
  ratio.y = {"T_s / T_b", "", false};
  const auto small = numbers_of(results, "/timeseries/temperature_small");
  const auto big = numbers_of(results, "/timeseries/temperature_big");
  if (!small.empty() && small.size() == big.size() && small.size() == time.size()) {
    Curve curve{.name = "T_s / T_b",
                .role = Role::all,
                .x = time,
                .y = small,
                .alternative_x = collisions.size() == time.size() ? collisions : std::vector<double>{}};
    for (std::size_t i = 0; i < small.size(); ++i) curve.y[i] /= big[i];
    Curve one = curve;
    std::fill(one.y.begin(), one.y.end(), 1.0);
    one.name = "equipartition", one.role = Role::guide, one.line = Line::dotted;
    ratio.curves = {std::move(curve), std::move(one)};
  } else {
    ratio.missing = temperature.missing;
  }

  Figure count = blank;
  count.id = "collisions", count.title = "Collisions per disk";
  count.caption = "A straight line of slope 1 is a steady collision rate; s counts each collision for both partners.";
  count.alternative_x = {};
  count.y = {"collisions per disk s", "", true};
  history("/timeseries/collisions", {"s", Role::all}, count);
  for (Curve& curve : count.curves) curve.alternative_x.clear();

  for (Figure* figure : {&temperature, &ratio, &count}) figures.push_back(std::move(*figure));
}

}  // namespace

std::vector<Figure> run_figures(const Results& results, const Summary& summary) {
  std::vector<Figure> figures{displacement_figure(results, summary)};
  add_scattering_figures(results, figures);
  add_velocity_figures(results, figures);
  add_history_figures(results, figures);
  for (Figure& figure : figures) {
    for (Curve& curve : figure.curves)  // a species that has no disks, say, has no numbers
      curve = points_where(curve, [](double x, double y) { return std::isfinite(x) && std::isfinite(y); });
    std::erase_if(figure.curves, [](const Curve& curve) { return curve.y.empty(); });
  }
  return figures;
}

}  // namespace sandglass
