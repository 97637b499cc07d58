// Figures as text: JSON for the page and for matplotlib, CSV for everything else.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sandglass/report/figure_data.h"

namespace sandglass {

/// All of the figure; numbers that are not known become null.
nlohmann::ordered_json figure_json(const Figure& figure);

/// Lines that begin with # say what is shown; then a row for each point of each curve, panels and insets included, and
/// for each element of a map: part, curve, level, x, second_x, y, error, value (of a map).
std::string figure_csv(const Figure& figure);

/// "agrees", "differs", "not enough data" for all checks of a figure: differs if one does, agrees if at least one does
/// and none differs.
Check::Outcome verdict(const Figure& figure);
std::string outcome_text(Check::Outcome outcome);

}  // namespace sandglass
