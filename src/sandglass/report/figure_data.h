// What a figure shows, made once as plain data: the HTML page draws it now, other writers can export it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/io/summary.h"

namespace sandglass {

struct Axis {
  std::string label;  ///< for example "time t"; empty: the figure has no such axis
  std::string unit;   ///< empty for a pure number
  bool log = false;   ///< drawn on a logarithmic scale unless the reader says otherwise
};

/// What a curve stands for; a writer chooses its colour by it.
enum class Role : std::uint8_t { all, small, big, fit, guide };
enum class Line : std::uint8_t { solid, dashed, dotted };

struct Curve {
  std::string name;
  Role role = Role::all;
  Line line = Line::solid;
  std::vector<double> x, y;
  std::vector<double> error;          ///< standard error of y; empty where there is none
  std::vector<double> alternative_x;  ///< the same points on the figure's second x axis; empty where there is none
};

struct Figure {
  std::string id;  ///< a word, unique on a page
  std::string title;
  std::string caption;  ///< what is seen, in a sentence or two
  Axis x, alternative_x, y;
  std::vector<Curve> curves;
  std::optional<double> parameter;               ///< of a family of figures: the wavenumber of a scattering function
  std::optional<std::array<double, 2>> y_range;  ///< of interest; none: all of the data
  std::string missing;  ///< why there is nothing (or not all) to see; empty when the figure is complete
};

/// All figures of one run from the datasets of its observables.h5 and the exponents of its summary. A figure whose
/// datasets are missing or do not fit together has no curves (or fewer) and says in `missing` what is.
std::vector<Figure> run_figures(const std::vector<Dataset>& results, const Summary& summary);

}  // namespace sandglass
