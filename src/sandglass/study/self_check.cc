#include "sandglass/study/self_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/observe/tally_averages.h"
#include "sandglass/theory/equation_of_state.h"

namespace sandglass {
namespace {

constexpr double allowed_sigmas = 4.5;  // one in 150 000, two-sided

// Relative standard error of a pressure or rate over n collisions, times sqrt(n): 1.0 to 1.2 in elastic fluids at
// eta = 0.1 ... 0.65 (40 stretches of 2.5 * 10^5 collisions). The scatter of the few stretches of a benchmark is only
// believed where it is larger.
constexpr double scatter_of_one = 1.2;

double disks_of(const Evidence& evidence) { return static_cast<double>(evidence.disks[small] + evidence.disks[big]); }

double least_error(std::uint64_t collisions) {
  return scatter_of_one / std::sqrt(static_cast<double>(std::max<std::uint64_t>(collisions, 1)));
}

double difference(const ExactSum& begin, const ExactSum& end) {
  ExactSum sum = end;
  sum.subtract(begin);
  return sum.value();
}

/// Z - 1 of an elastic fluid: right to 0.1 % by the formula (0.06 % seen), and to 1/N for what finite numbers change.
CheckedFigure check_pressure(const Evidence& evidence) {
  const auto& boundaries = evidence.boundaries;
  const double disks = disks_of(evidence);
  const std::vector<double> temperatures(boundaries.size() - 1, evidence.end_energy / disks);
  const Estimate found =
      tally_averages(boundaries, evidence.interval_length, temperatures, evidence.disks).compressibility_factor;
  const double expected = fluid_compressibility_factor(
      evidence.mixture, static_cast<double>(evidence.disks[big]) / disks, evidence.packing_fraction);
  const double sigma =
      std::fmax((expected - 1) * least_error(boundaries.back().collisions() - boundaries.front().collisions()),
                found.error);  // fmax passes over the NaN of a single interval
  return {"compressibility factor, against the equation of state", found.value, expected,
          (expected - 1) * (0.001 + 1 / disks) + allowed_sigmas * sigma};
}

/// Counted collisions over those that the frames foretell, for pairs of species and for all. What the extrapolation to
/// contact leaves out: contact_range.
std::vector<CheckedFigure> check_rates(const Evidence& evidence) {
  const Tally &first = evidence.boundaries.front(), &last = evidence.boundaries.back();
  const double time = evidence.interval_length * static_cast<double>(evidence.boundaries.size() - 1);
  const double left_out = (evidence.restitution == 1 ? 0.003 : 0.02) + 1 / disks_of(evidence);
  const auto figure = [&](const char* pair, std::uint64_t counted, const Estimate& foretold) {
    const double sigma = std::hypot(foretold.error / foretold.value, least_error(counted));
    return CheckedFigure{fmt::format("collisions counted over those foretold by g(contact), {}", pair),
                         static_cast<double>(counted) / (foretold.value * time), 1, left_out + allowed_sigmas * sigma};
  };
  std::vector<CheckedFigure> figures;
  double sum = 0, squares = 0;
  for (std::size_t pair = 0; pair < 3; ++pair) {
    const Estimate& foretold = evidence.foretold[pair];
    constexpr std::array<const char*, 3> names{"small-small", "small-big", "big-big"};
    figures.push_back(figure(names[pair], last.contacts[pair] - first.contacts[pair], foretold));
    sum += foretold.value;
    squares += foretold.error * foretold.error;
  }
  figures.push_back(figure("all", last.collisions() - first.collisions(), {sum, std::sqrt(squares)}));
  return figures;
}

/// Injected minus dissipated minus gained, over what was turned over. Each change of a velocity rounds by 2^-53: a
/// random walk of 10^8 of them makes 1e-12.
CheckedFigure check_energy(const Evidence& evidence) {
  const Tally &first = evidence.start, &last = evidence.boundaries.back();
  const double injected = difference(first.injected, last.injected);
  const double missing =
      injected - difference(first.dissipated, last.dissipated) - (evidence.end_energy - evidence.start_energy);
  return {"energy balance", missing / std::fmax(injected, evidence.start_energy), 0, 1e-9};
}

}  // namespace

bool CheckedFigure::passed() const { return std::fabs(measured - expected) <= tolerance; }

bool has_equation_of_state(double packing_fraction, double restitution) {
  return restitution == 1 && packing_fraction <= 0.6;
}

std::vector<CheckedFigure> check_figures(const Evidence& evidence) {
  std::vector<CheckedFigure> figures;
  if (has_equation_of_state(evidence.packing_fraction, evidence.restitution))
    figures.push_back(check_pressure(evidence));
  else
    figures = check_rates(evidence);
  figures.push_back(check_energy(evidence));
  // 1e-9 R_s: contact times are rounded, to 1e-13 or so of a distance.
  figures.push_back({"deepest overlap, in contact distances", evidence.deepest_overlap, 0, 3e-10});
  return figures;
}

void require_passed(std::span<const CheckedFigure> figures) {
  std::string failures;
  for (const CheckedFigure& figure : figures)
    if (!figure.passed())
      failures += fmt::format("{}{}: {:.8g}, expected {:.8g} +- {:.2g}", failures.empty() ? "" : "; ", figure.quantity,
                              figure.measured, figure.expected, figure.tolerance);
  if (failures.empty()) return;
  throw RunError(fmt::format(
      "the self-check failed ({}). The engine computes something else than hard disks, or the disks have not settled: "
      "repeat with a longer --age; if it fails again, the rate means nothing, please report this",
      failures));
}

}  // namespace sandglass
