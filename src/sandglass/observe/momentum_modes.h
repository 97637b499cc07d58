// Velocity structure factors: how the momenta of the disks are correlated in space.
#pragma once

#include <vector>

#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/scattering.h"

namespace sandglass {

/// The wave vectors to look at: shells of a few vectors at wavenumbers that grow by a quarter from 2 pi / L up to
/// `longest`.
std::vector<WaveShell> momentum_shells(double box_length, double longest);

/// One frame, per shell: S(k) = <|k^.J_k|^2> / sum m (longitudinal) and <|k^ x J_k|^2> / sum m (transverse) with the
/// momentum density J_k = sum_j m_j v_j exp(-i k.r_j), averaged over the vectors of the shell. Per component in units
/// of temperature: both are T at every k in elastic equilibrium.
struct MomentumStructure {
  std::vector<double> transverse, longitudinal;
};
MomentumStructure momentum_structure(const Snapshot& snapshot, const Population& population,
                                     const std::vector<WaveShell>& shells);

/// The length xi over which momenta are correlated: least squares of a + b / (1 + k^2 xi^2) (Ornstein and Zernike) to
/// the transverse structure factor at k <= 1 / R_s, all shells weighing alike; xi is looked for between 1 R_s and L /
/// (2 pi). Kicks that conserve momentum leave a plateau below k = 1 / xi; single ones a divergence 1/k^2, xi then is
/// the longest. Error by jackknife over the intervals (blocks of frames), NaN where xi is an end of that range. Both
/// NaN where nothing is correlated: |b| below three errors.
Estimate velocity_correlation_length(const IntervalSeries& transverse, double box_length);

}  // namespace sandglass
