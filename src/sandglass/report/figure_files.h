// Figures as files: data by this program, pictures by Python's matplotlib.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/report/figure_data.h"

namespace sandglass {

/// Writes ID.csv and ID.json of each figure into `folder`, which is made, and removes its older pictures.
void write_figure_data(const std::vector<Figure>& figures, const std::filesystem::path& folder);

/// Draws ID.svg, ... of each figure that has data, from the JSON in `folder`. `formats` are "svg", "pdf", "png". Runs
/// $SANDGLASS_PYTHON, or /usr/bin/python3, on a script that is part of this program. Throws RunError when there is no
/// Python, no matplotlib, or drawing fails.
void draw_figures(const std::vector<Figure>& figures, const std::filesystem::path& folder,
                  const std::vector<std::string>& formats);

}  // namespace sandglass
