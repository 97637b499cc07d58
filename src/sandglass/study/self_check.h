// Is a fast engine also right? Figures of a benchmark against what they must be.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "sandglass/core/state.h"
#include "sandglass/observe/interval_series.h"

namespace sandglass {

/// One figure: passed when it is within `tolerance` of what is expected (and a number).
struct CheckedFigure {
  std::string quantity;
  double measured = 0, expected = 0, tolerance = 0;
  [[nodiscard]] bool passed() const;
};

/// What a benchmark saw of its measured stretch.
struct Evidence {
  Mixture mixture;
  std::array<std::size_t, species_count> disks{};
  double packing_fraction = 0, restitution = 1;
  double interval_length = 0;               ///< physical time
  std::vector<Tally> boundaries;            ///< at the ends of the intervals, one more than there are intervals
  Tally start;                              ///< before anything moved
  double start_energy = 0, end_energy = 0;  ///< kinetic, there and at the end
  std::array<Estimate, 3> foretold{};       ///< collisions per time ss, sb, bb, from frames (ContactRate)
  double deepest_overlap = 0;               ///< at the end, in contact distances
};

/// Whether the pressure is checked, by the equation of state (elastic, up to packing fraction 0.6, where that is exact
/// to 0.1 %), or the collision rates, by the frames.
bool has_equation_of_state(double packing_fraction, double restitution);

/// Down to here frames foretell the collision rates to 2 %; at 0.3 and eta = 0.8 they are 13 % short (contact_range).
inline constexpr double least_checked_restitution = 0.5;

/// Pressure or collision rates, energy, overlap. A right engine fails in one of 25 000 benchmarks (six figures, 4.5
/// sigma each). At the default length one fails that misses 3 % of all contacts where elastic, 10 % at eps = 0.5.
std::vector<CheckedFigure> check_figures(const Evidence& evidence);

/// Throws RunError naming the figures that did not pass, if any.
void require_passed(std::span<const CheckedFigure> figures);

}  // namespace sandglass
