// Affine change of density.
#pragma once

#include "sandglass/core/state.h"

namespace sandglass {

/// Scales box and centres by one factor, radii kept, so that the area fraction becomes `packing_fraction`; centres stay
/// in [0, L). Expansion removes overlaps: distance / (R_i + R_j) grows by sqrt(eta_old / eta_new). Nothing is checked.
void expand(State& state, double packing_fraction);

}  // namespace sandglass
