// Measured functions of the lag, as they stand in the results of a run or of a state point.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sandglass/report/figure_data.h"

namespace sandglass {

using Results = std::vector<Dataset>;

/// One measured function of the lag, or several rows of it (one for each wavenumber).
struct Correlation {
  std::vector<double> time, collisions, value, error;
  [[nodiscard]] std::size_t lags() const { return time.size(); }
};

/// Reads the group /dynamics/`species`/`quantity`. What does not fit is said in `missing` and nothing is returned.
std::optional<Correlation> correlation(const Results& results, std::string_view species, std::string_view quantity,
                                       std::string& missing, std::size_t rows = 1);

/// The points of row `row` whose value is a number, divided by `scale`; collisions are the second x axis.
Curve curve_of(const Correlation& c, std::string name, Role role, std::size_t row = 0, double scale = 1);

}  // namespace sandglass
