// What an observer is shown: all disks at one moment, by id, advanced to that moment. Making one changes no record.
#pragma once

#include <cstddef>
#include <vector>

#include "sandglass/core/state.h"

namespace sandglass {

struct Frame {
  double time = 0;                 ///< physical time since the start of the run
  double collisions_per_disk = 0;  ///< s = 2 N_coll / N since the start of the run
  std::vector<double> x, y;        ///< unwrapped centres, by id
  std::vector<double> vx, vy;

  [[nodiscard]] std::size_t size() const { return x.size(); }
  void resize(std::size_t n) {
    for (auto* v : {&x, &y, &vx, &vy}) v->resize(n);
  }
};

/// All disks of `state` at its own time `state.now`.
void make_frame(const State& state, Frame& frame);

}  // namespace sandglass
