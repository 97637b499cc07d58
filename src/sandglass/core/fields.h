// How data leave an observer: fields (what a checkpoint must hold) and datasets (what a reader is given).
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sandglass/core/exact_sum.h"

namespace sandglass {

/// One member of an accumulator, by name. An observer lists its fields once; saving and restoring both walk that list.
struct Field {
  std::string name;
  std::variant<double*, std::uint64_t*, std::vector<double>*, std::vector<std::uint64_t>*, std::vector<ExactSum>*>
      target;
};

/// One array of results: where it stands in observables.h5, its shape (row-major), its values and their unit
/// (empty for a pure number). Counts are unsigned integers, everything else double.
struct Dataset {
  std::string path;  ///< for example "/dynamics/small/mean_square_displacement/value"
  std::vector<std::size_t> shape;
  std::variant<std::vector<double>, std::vector<std::uint64_t>> values;
  std::string unit;
  std::vector<std::pair<std::string, double>> attributes{};  ///< numbers that say how it was measured, by name
};

}  // namespace sandglass
