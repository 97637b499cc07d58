#include "sandglass/report/point_family.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/correlation.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

bool better(const StatePoint& a, const StatePoint& b, Prefer prefer) {
  if (prefer == Prefer::largest && a.config.system.particles != b.config.system.particles)
    return a.config.system.particles > b.config.system.particles;
  return a.length() > b.length();
}

Family family_at(const Study& study, bool by_density, double fixed, Prefer prefer) {
  Family family{{}, by_density, fixed, prefer};
  for (const StatePoint& point : study.points) {
    if (!same_level(by_density ? point.restitution() : point.packing_fraction(), fixed)) continue;
    const auto twin = std::find_if(family.points.begin(), family.points.end(), [&](const StatePoint* other) {
      return same_level(family.level(*other), family.level(point));
    });
    if (twin == family.points.end())
      family.points.push_back(&point);
    else if (better(point, **twin, prefer))
      *twin = &point;
  }
  std::sort(family.points.begin(), family.points.end(),
            [&](const StatePoint* a, const StatePoint* b) { return family.level(*a) < family.level(*b); });
  return family;
}

template <class Level>
std::vector<double> levels_of(const Study& study, Level&& level) {
  std::vector<double> levels;
  for (const StatePoint& point : study.points) levels.push_back(level(point));
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end(), same_level), levels.end());
  return levels;
}

}  // namespace

bool same_level(double a, double b) { return std::abs(a - b) < 5e-4; }

Family densities_at(const Study& study, double restitution, Prefer prefer) {
  return family_at(study, true, restitution, prefer);
}

Family restitutions_at(const Study& study, double density, Prefer prefer) {
  return family_at(study, false, density, prefer);
}

Family few_of(Family family, std::span<const double> chosen) {
  std::vector<bool> wanted(family.points.size());
  for (const double level : chosen) {
    const auto nearer = [&](const StatePoint* a, const StatePoint* b) {  // of two as near the lower one
      return std::abs(family.level(*a) - level) < std::abs(family.level(*b) - level) - 1e-9;
    };
    const auto nearest = std::min_element(family.points.begin(), family.points.end(), nearer);
    if (nearest != family.points.end()) wanted[static_cast<std::size_t>(nearest - family.points.begin())] = true;
  }
  std::vector<const StatePoint*> few;  // in the order of their levels
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i]) few.push_back(family.points[i]);
  if (few.size() >= 3) family.points = std::move(few);
  return family;
}

std::vector<double> restitutions_of(const Study& study) {
  return levels_of(study, [](const StatePoint& p) { return p.restitution(); });
}

std::vector<double> densities_of(const Study& study) {
  return levels_of(study, [](const StatePoint& p) { return p.packing_fraction(); });
}

double shown_restitution(const Study& study, double wanted) {
  double best = wanted;
  std::size_t most = 0;
  for (const double restitution : restitutions_of(study)) {
    if (same_level(restitution, wanted)) return wanted;
    const std::size_t count = densities_at(study, restitution).points.size();
    if (count > most) best = restitution, most = count;
  }
  return best;
}

const StatePoint* shown_point(const Study& study, double density, double restitution, Figure& figure,
                              const std::function<bool(const StatePoint&)>& has) {
  const StatePoint* best = nullptr;
  const auto distance = [&](const StatePoint& p) {
    return std::abs(p.packing_fraction() - density) + std::abs(p.restitution() - restitution);
  };
  for (const StatePoint& point : study.points) {
    if (!has(point)) continue;
    const bool nearer = best == nullptr || distance(point) < distance(*best) - 1e-9;
    if (nearer || (std::abs(distance(point) - distance(*best)) < 1e-9 && better(point, *best, Prefer::longest)))
      best = &point;
  }
  if (best == nullptr) {
    figure.missing =
        fmt::format("Not measured in these runs. The figure needs a run at η = {:g}, ε = {:g} that measures it.",
                    density, restitution);
    return nullptr;
  }
  figure.title += fmt::format(", η = {:g}, ε = {:g}", best->packing_fraction(), best->restitution());
  figure.caption += fmt::format(" Here N = {}.", best->config.system.particles);
  if (!is_point(best, density, restitution))
    figure.missing = fmt::format(
        "The paper's point, η = {:g} and ε = {:g}, is not in this study; the nearest is shown.", density, restitution);
  return best;
}

bool is_point(const StatePoint* point, double density, double restitution) {
  return point != nullptr && same_level(point->packing_fraction(), density) &&
         same_level(point->restitution(), restitution);
}

void add_family(Figure& figure, const Family& family, std::span<const double> wanted, const std::string& quantity,
                const MakeCurve& make) {
  const char* other = family.by_density ? "ε" : "η";
  figure.family = family.by_density ? density_axis : restitution_axis;
  std::vector<double> lacking(wanted.begin(), wanted.end()), unmeasured;
  for (const StatePoint* point : family.points) {
    const double level = family.level(*point);
    std::erase_if(lacking, [&](double w) { return same_level(w, level); });
    std::optional<Curve> curve = make(*point);
    if (!curve || curve->y.empty()) {
      unmeasured.push_back(level);
      continue;
    }
    curve->role = Role::family;
    curve->level = level;
    if (curve->name.empty()) curve->name = fmt::format("{} = {:g}", family.symbol(), level);
    figure.curves.push_back(std::move(*curve));
  }
  std::string text;
  if (family.points.empty())
    text = fmt::format("This study has no runs at {} = {:g}. Needed are {} = {}.", other, family.fixed, family.symbol(),
                       listed(wanted));
  else if (!lacking.empty())
    text =
        fmt::format("Not in this study at {} = {:g}: {} = {}.", other, family.fixed, family.symbol(), listed(lacking));
  if (!unmeasured.empty())
    text +=
        fmt::format("{}Without {}: {} = {}.", text.empty() ? "" : " ", quantity, family.symbol(), listed(unmeasured));
  if (!text.empty()) figure.missing += (figure.missing.empty() ? "" : " ") + text;
}

std::optional<Curve> small_curve(const StatePoint& point, const std::string& quantity) {
  std::string missing;
  const auto c = correlation(point.results, "small", quantity, missing);
  return c ? std::optional(curve_of(*c, "", Role::small)) : std::nullopt;
}

std::optional<Curve> small_curve(const StatePoint& point, const std::string& quantity, double wavenumber) {
  const auto k = numbers_of(point.results, "/dynamics/small/" + quantity + "/wavenumber");
  const auto nearest = std::min_element(
      k.begin(), k.end(), [&](double a, double b) { return std::abs(a - wavenumber) < std::abs(b - wavenumber); });
  if (nearest == k.end() || std::abs(*nearest - wavenumber) > 0.1 * wavenumber) return std::nullopt;
  std::string missing;
  const auto c = correlation(point.results, "small", quantity, missing, k.size());
  if (!c) return std::nullopt;
  return curve_of(*c, "", Role::small, static_cast<std::size_t>(nearest - k.begin()));
}

std::optional<Curve> plain_curve(const StatePoint& point, const std::string& group, const std::string& x,
                                 const std::string& y, const std::string& error) {
  Curve all{.name = ""};
  all.x = numbers_of(point.results, group + "/" + x);
  const auto values = numbers_of(point.results, group + "/" + y),
             errors = numbers_of(point.results, group + "/" + error);
  if (values.empty() || values.size() != all.x.size()) return std::nullopt;
  Curve curve{.name = ""};
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    curve.x.push_back(all.x[i]);
    curve.y.push_back(values[i]);
    if (errors.size() == values.size()) curve.error.push_back(errors[i]);
  }
  return curve;
}

Curve against_collisions(Curve curve) {
  if (curve.alternative_x.size() != curve.x.size()) return {};
  std::swap(curve.x, curve.alternative_x);
  return curve;
}

std::vector<Curve> against_density(const Study& study, const Number& number) {
  std::vector<Curve> curves;
  for (const double restitution : restitutions_of(study)) {
    Curve curve{.name = fmt::format("ε = {:g}", restitution), .role = Role::family, .level = restitution};
    for (const StatePoint* point : densities_at(study, restitution).points) {
      const Measured value = number(*point);
      if (!std::isfinite(value.value)) continue;
      curve.x.push_back(point->packing_fraction());
      curve.y.push_back(value.value);
      curve.error.push_back(value.error);
    }
    if (!curve.x.empty()) curves.push_back(std::move(curve));
  }
  return curves;
}

std::vector<Ranked> ranked(const Curve& curve) {
  std::vector<Ranked> sequence;
  for (std::size_t i = 0; i < curve.x.size(); ++i)
    sequence.push_back({curve.x[i], {curve.y[i], curve.error.empty() ? Measured{}.error : curve.error[i]}});
  return sequence;
}

Figure paper_figure(int number, std::string title, std::string caption, Axis x, Axis y, std::string statement) {
  Figure figure{.id = fmt::format("fig{:02}", number),
                .title = fmt::format("{}. {}", number, title),
                .caption = std::move(caption),
                .x = std::move(x)};
  figure.y = std::move(y);
  figure.statement = std::move(statement);
  return figure;
}

Figure part_of(const Figure& whole, const std::string& suffix, std::string title, Axis x, Axis y) {
  Figure part{.id = whole.id + suffix, .title = std::move(title), .caption = {}, .x = std::move(x)};
  part.y = std::move(y);
  return part;
}

Curve iso_line(const Figure& figure, double level, std::string name) {
  Curve line{.name = std::move(name), .role = Role::family, .level = level};
  for (const Curve& curve : figure.curves) {
    const Measured density = crossing(curve, level);
    if (!std::isfinite(density.value)) continue;
    line.x.push_back(curve.level);
    line.y.push_back(density.value);
    line.error.push_back(density.error);
  }
  return line;
}

Curve guide(std::string name, std::vector<double> x, std::vector<double> y) {
  return {.name = std::move(name), .role = Role::guide, .line = Line::dotted, .x = std::move(x), .y = std::move(y)};
}

std::string listed(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:g}", text.empty() ? "" : ", ", value);
  return text;
}

}  // namespace sandglass
