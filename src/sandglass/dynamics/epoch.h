// The epoch: at fixed physical times, in every run, all records are advanced and all times counted anew.
#pragma once

#include "sandglass/core/state.h"

namespace sandglass {

/// One mean free time by the formula times this many is an epoch. Rare enough to cost nothing, often enough that times
/// within it keep 13 digits of a mean free time.
inline constexpr int beats_per_epoch = 1024;

/// Takes a state in which every event up to the end of the epoch is done to the start of the next one.
void pass_epoch(State& state);

}  // namespace sandglass
