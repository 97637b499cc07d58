// How long work speaks to whoever waits for it.
#pragma once

#include <functional>
#include <string_view>

namespace sandglass {

/// Called now and then with what is being done and the fraction done in [0, 1]. May be empty.
using Progress = std::function<void(std::string_view stage, double fraction)>;

inline void report_progress(const Progress& progress, std::string_view stage, double fraction) {
  if (progress) progress(stage, fraction);
}

}  // namespace sandglass
