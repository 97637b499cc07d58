// Pressure, collision rates and energy flow from differences of tallies.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sandglass/core/state.h"
#include "sandglass/observe/interval_series.h"

namespace sandglass {

/// Averages over the measured stretch, with standard errors over its intervals.
struct TallyAverages {
  Estimate collision_rate;  ///< omega: collisions per disk and time; each counts for both its disks
  /// omega_ij: collisions per time of one disk of species i with disks of species j, by [i][j].
  std::array<std::array<Estimate, species_count>, species_count> partner_rate;
  Estimate compressibility_factor;                ///< Z = p V / (N T)
  Estimate injected, dissipated;                  ///< energy per disk and time; equal in the steady state
  std::array<Estimate, species_count> kick_rate;  ///< kicks per disk of the species and time
  double elastic_fraction = 0;                    ///< collisions made elastic by the TC model
};

/// One value per interval.
struct IntervalFlows {
  std::vector<double> compressibility_factor;
  std::vector<double> injected, dissipated;  ///< energy per disk and time
};

/// From the same as tally_averages below, by the same formulas.
IntervalFlows interval_flows(std::span<const Tally> boundaries, double interval_length,
                             std::span<const double> temperatures, std::size_t disks);

/// From tallies at the interval boundaries (intervals + 1 of them) and the mean temperature of each interval.
///
/// Pressure in 2D: p V = N T + (1/2) d(virial)/dt with virial = sum over collisions of impulse times distance of the
/// centres [Alder & Wainwright 1960], so Z - 1 = (1 / (2 N T)) d(virial)/dt. At zero total momentum the N - 1 free
/// velocities carry T = sum m w^2 / (2 N), i.e. relative velocities belong to a temperature T N/(N-1) of the infinite
/// system; the excess is therefore multiplied by (N-1)/N.
TallyAverages tally_averages(std::span<const Tally> boundaries, double interval_length,
                             std::span<const double> temperatures, std::array<std::size_t, species_count> disks);

}  // namespace sandglass
