// What a figure shows, made once as plain data: the HTML page draws it, CSV, JSON and matplotlib get the same.
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

/// What a curve stands for; a writer chooses its colour by it. A curve of a `family` is coloured by its level.
enum class Role : std::uint8_t { all, small, big, fit, guide, family };
enum class Line : std::uint8_t { solid, dashed, dotted, points };

struct Curve {
  std::string name;
  Role role = Role::all;
  Line line = Line::solid;
  std::vector<double> x = {}, y = {};
  std::vector<double> error = {};          ///< standard error of y; empty where there is none
  std::vector<double> alternative_x = {};  ///< the same points on the figure's second x axis; empty where there is none
  double level = 0;                        ///< value of the parameter that tells the curves of a family apart
};

/// A function on a regular grid: value[row * columns + column] at x0 + column * dx, y0 + row * dy.
struct HeatMap {
  double x0 = 0, dx = 1, y0 = 0, dy = 1;
  std::size_t columns = 0, rows = 0;
  std::vector<double> values = {};
  Axis scale = {};  ///< what the colour means
};

/// A statement held against the data. No data, no agreement.
struct Check {
  enum class Outcome : std::uint8_t { agrees, differs, not_enough_data };
  std::string claim;  ///< what is said, in a sentence
  Outcome outcome = Outcome::not_enough_data;
  std::string finding = {};  ///< what was found, with numbers and errors; or which data are lacking
};

struct Figure {
  std::string id;  ///< a word, unique on a page
  std::string title;
  std::string caption;  ///< what is seen, in a sentence or two
  Axis x, alternative_x = {}, y = {};
  std::vector<Curve> curves = {};
  Axis family = {};                      ///< what the levels of the family's curves are
  std::optional<double> parameter = {};  ///< of a family of figures: the wavenumber of a scattering function
  std::optional<std::array<double, 2>> y_range = {};  ///< of interest; none: all of the data
  std::string missing = {};  ///< why there is nothing (or not all) to see; empty when the figure is complete
  std::optional<HeatMap> map = {};
  std::vector<Figure> panels = {};  ///< more of the same, to stand beside it
  std::vector<Figure> insets = {};  ///< details, small
  std::string statement = {};       ///< what the paper reports
  std::vector<Check> checks = {};

  [[nodiscard]] bool empty() const { return curves.empty() && !map; }
};

/// All figures of one run from the datasets of its observables.h5 and the exponents of its summary. A figure whose
/// datasets are missing or do not fit together has no curves (or fewer) and says in `missing` what is.
std::vector<Figure> run_figures(const std::vector<Dataset>& results, const Summary& summary);

}  // namespace sandglass
