// Initial states, one file pair per method. Every method returns a State with box, mixture, seed and disks by id (the
// small ones first, [0, small_count), then the big ones; ids say nothing about positions), all at rest at time 0, free
// of overlap and of exactly the area fraction asked for. Velocities, kick clocks, collision law, drive and epoch length
// are the caller's to set. Bits follow from the arguments alone, the same on every machine.
#pragma once

#include "sandglass/prepare/check.h"   // IWYU pragma: export
#include "sandglass/prepare/expand.h"  // IWYU pragma: export
#include "sandglass/prepare/file.h"    // IWYU pragma: export
#include "sandglass/prepare/insert.h"  // IWYU pragma: export
#include "sandglass/prepare/quench.h"  // IWYU pragma: export
#include "sandglass/prepare/repeat.h"  // IWYU pragma: export
