#include "sandglass/report/curve_math.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sandglass/report/number.h"

namespace sandglass {
namespace {

using Outcome = Check::Outcome;

double error_at(const Curve& curve, std::size_t i) { return curve.error.empty() ? Measured{}.error : curve.error[i]; }

/// The indices of the outermost points inside [x_i / spread, x_i spread], equally many on both sides.
std::pair<std::size_t, std::size_t> window(const Curve& curve, std::size_t i, double spread) {
  std::size_t low = i, high = i;
  while (low > 0 && curve.x[low - 1] >= curve.x[i] / spread) --low;
  while (high + 1 < curve.x.size() && curve.x[high + 1] <= curve.x[i] * spread) ++high;
  const std::size_t steps = std::min(i - low, high - i);
  return {i - steps, i + steps};
}

template <class Quotient>
Curve slopes(const Curve& curve, double spread, Quotient&& quotient) {
  Curve slope = curve;
  for (auto* column : {&slope.x, &slope.y, &slope.error, &slope.alternative_x}) column->clear();
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const auto [low, high] = window(curve, i, spread);
    if (low == i) continue;
    const Measured q = quotient(low, high);
    if (!std::isfinite(q.value)) continue;
    slope.x.push_back(curve.x[i]);
    slope.y.push_back(q.value);
    if (!curve.error.empty()) slope.error.push_back(q.error);
    if (!curve.alternative_x.empty()) slope.alternative_x.push_back(curve.alternative_x[i]);
  }
  return slope;
}

/// The points whose index `keep` wants.
template <class Keep>
Curve selected(const Curve& curve, Keep&& keep) {
  Curve part = curve;
  for (auto column : {&Curve::x, &Curve::y, &Curve::error, &Curve::alternative_x}) {
    (part.*column).clear();
    if ((curve.*column).empty()) continue;
    for (std::size_t i = 0; i < curve.x.size(); ++i)
      if (keep(i)) (part.*column).push_back((curve.*column)[i]);
  }
  return part;
}

Check monotonic(std::string claim, std::span<const Ranked> sequence, const std::string& what,
                const std::string& argument, double sign) {
  std::vector<Ranked> known;
  for (const Ranked& r : sequence)
    if (std::isfinite(r.value.value) && std::isfinite(r.value.error)) known.push_back(r);
  if (known.size() < 2)
    return {std::move(claim), Outcome::not_enough_data,
            fmt::format("{} is known with its error at {} value{} of {} only.", what, known.size(),
                        known.size() == 1 ? "" : "s", argument)};
  const auto step = [&](const Ranked& a, const Ranked& b) {
    return sign * (b.value.value - a.value.value) / standard_error_of_difference(a.value, b.value);
  };
  const auto text = [](const Ranked& r) { return with_error(r.value.value, r.value.error); };
  for (std::size_t i = 1; i < known.size(); ++i) {
    const Ranked &a = known[i - 1], &b = known[i];
    if (step(a, b) < -significant_order)
      return {std::move(claim), Outcome::differs,
              fmt::format("{} goes from {} at {} = {:g} to {} at {:g}, the other way by {:.1f} standard errors.", what,
                          text(a), argument, a.argument, text(b), b.argument, -step(a, b))};
  }
  const Ranked &first = known.front(), &last = known.back();
  const bool clear = step(first, last) > significant_order;
  return {std::move(claim), clear ? Outcome::agrees : Outcome::not_enough_data,
          fmt::format("{} goes from {} at {} = {:g} to {} at {:g}{}.", what, text(first), argument, first.argument,
                      text(last), last.argument, clear ? "" : ", which is within the errors")};
}

}  // namespace

Curve local_exponent(const Curve& curve, double spread) {
  return slopes(curve, spread, [&](std::size_t a, std::size_t b) -> Measured {
    const double width = std::log(curve.x[b] / curve.x[a]);
    return {std::log(curve.y[b] / curve.y[a]) / width,
            std::hypot(error_at(curve, a) / curve.y[a], error_at(curve, b) / curve.y[b]) / width};
  });
}

Curve derivative(const Curve& curve, double spread) {
  return slopes(curve, spread, [&](std::size_t a, std::size_t b) -> Measured {
    const double width = curve.x[b] - curve.x[a];
    return {(curve.y[b] - curve.y[a]) / width, std::hypot(error_at(curve, a), error_at(curve, b)) / width};
  });
}

Measured value_at(const Curve& curve, double x) {
  if (curve.x.empty() || !(x >= curve.x.front()) || x > curve.x.back()) return {};
  const auto above = static_cast<std::size_t>(std::lower_bound(curve.x.begin(), curve.x.end(), x) - curve.x.begin());
  if (above == 0 || curve.x[above] == x) return {curve.y[above], error_at(curve, above)};
  const std::size_t below = above - 1;
  const double part = std::log(x / curve.x[below]) / std::log(curve.x[above] / curve.x[below]);
  return {std::lerp(curve.y[below], curve.y[above], part),
          std::lerp(error_at(curve, below), error_at(curve, above), part)};
}

Measured crossing(const Curve& curve, double level) {
  for (std::size_t i = 1; i < curve.x.size(); ++i) {
    const double a = curve.y[i - 1], b = curve.y[i];
    if ((a < level) == (b < level) || !(curve.x[i - 1] > 0)) continue;
    const bool logarithmic = a > 0 && b > 0 && level > 0;
    const double part = logarithmic ? std::log(level / a) / std::log(b / a) : (level - a) / (b - a);
    const double x = curve.x[i - 1] * std::pow(curve.x[i] / curve.x[i - 1], part);
    const double per_log_x = (b - a) / std::log(curve.x[i] / curve.x[i - 1]);
    const double error = std::lerp(error_at(curve, i - 1), error_at(curve, i), part);
    return {x, error * x / std::abs(per_log_x)};
  }
  return {};
}

Curve points_where(const Curve& curve, const std::function<bool(double, double)>& keep) {
  return selected(curve, [&](std::size_t i) { return keep(curve.x[i], curve.y[i]); });
}

Curve points_known(const Curve& curve, const std::function<bool(double, double)>& keep) {
  return selected(curve, [&](std::size_t i) { return !curve.error.empty() && keep(curve.y[i], curve.error[i]); });
}

Curve between(const Curve& curve, double from, double to) {
  return points_where(curve, [&](double x, double) { return x >= from && x <= to; });
}

double standard_error_of_difference(const Measured& a, const Measured& b) { return std::hypot(a.error, b.error); }

Check compare(std::string claim, const Measured& found, const Measured& paper, const std::string& where) {
  if (!std::isfinite(found.value))
    return {std::move(claim), Outcome::not_enough_data, fmt::format("It was not measured {}.", where)};
  if (!std::isfinite(found.error))
    return {std::move(claim), Outcome::not_enough_data,
            fmt::format("Found {} {}, without an error: it takes several intervals or starts.",
                        short_number(found.value), where)};
  const double difference = found.value - paper.value, error = standard_error_of_difference(found, paper);
  const bool agrees = std::abs(difference) <= significant * error;
  return {std::move(claim), agrees ? Outcome::agrees : Outcome::differs,
          fmt::format("Found {} {}: {} by {:.2g}, {:.1f} standard errors.", with_error(found.value, found.error), where,
                      difference < 0 ? "lower" : "higher", std::abs(difference), std::abs(difference) / error)};
}

Check rises(std::string claim, std::span<const Ranked> sequence, const std::string& what, const std::string& argument) {
  return monotonic(std::move(claim), sequence, what, argument, 1);
}

Check falls(std::string claim, std::span<const Ranked> sequence, const std::string& what, const std::string& argument) {
  return monotonic(std::move(claim), sequence, what, argument, -1);
}

Check not_all_flat(std::string claim, std::string lacking, std::span<const NamedExponent> exponents,
                   const std::string& heading) {
  Check check{std::move(claim), Check::Outcome::not_enough_data, std::move(lacking)};
  std::string bent, flat;
  std::size_t flat_ones = 0;
  for (const auto& [name, exponent] : exponents) {
    const std::string text = fmt::format(" {} ({});", with_error(exponent.value, exponent.error), name);
    if (std::abs(exponent.value) > significant_order * exponent.error)
      bent += text;
    else if (exponent.error < 0.05)
      flat += text, ++flat_ones;
  }
  if (bent.empty() && flat.empty()) return check;
  if (!bent.empty()) check.outcome = Check::Outcome::agrees;
  if (bent.empty() && flat_ones > 1) check.outcome = Check::Outcome::differs;
  check.finding = heading + bent + (flat.empty() ? "" : " zero within three errors:" + flat);
  check.finding.back() = '.';
  return check;
}

Check joined(std::string claim, std::span<const Check> parts) {
  Check all{std::move(claim), Outcome::not_enough_data, {}};
  const auto count = [&](Outcome outcome) {
    return std::count_if(parts.begin(), parts.end(), [&](const Check& part) { return part.outcome == outcome; });
  };
  if (count(Outcome::differs) > 0)
    all.outcome = Outcome::differs;
  else if (count(Outcome::agrees) > 0)
    all.outcome = Outcome::agrees;
  if (parts.size() > 1)
    all.finding = fmt::format("Of {} sequences {} agree, {} differ, {} lack data. ", parts.size(),
                              count(Outcome::agrees), count(Outcome::differs), count(Outcome::not_enough_data));
  std::size_t told = 0;
  for (const Check& part : parts)
    if (part.outcome == all.outcome && told++ < 3) all.finding += part.finding + " ";
  if (parts.empty()) all.finding = "There are no data.";
  while (all.finding.ends_with(' ')) all.finding.pop_back();
  return all;
}

}  // namespace sandglass
