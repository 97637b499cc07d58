// The figures of the paper, made from the runs of a study, each held against what the paper reports; and those of what
// is measured beyond it.
#pragma once

#include <vector>

#include "sandglass/report/figure_data.h"
#include "sandglass/study/collect.h"

namespace sandglass {

inline constexpr int figure_count = 24;

/// Figures 1 to 16 of Gholami, Fiege & Zippelius (2011) and the bond order (17), then what the paper does not show (18
/// to 24, without a statement), ids "fig01" ... "fig24". A figure shows what the study has of it and says in `missing`
/// what the paper has beyond; without any data it says which runs it would need. docs/figures.md has the rules of the
/// checks.
std::vector<Figure> paper_figures(const Study& study);

/// Numbers of all state points against density, a curve for each restitution.
std::vector<Figure> overview_figures(const Study& study);

// By theme, in the order of their numbers.
void add_velocity_figures(const Study& study, std::vector<Figure>& figures);      ///< 1 to 4
void add_displacement_figures(const Study& study, std::vector<Figure>& figures);  ///< 5 to 7, 13
void add_scattering_figures(const Study& study, std::vector<Figure>& figures);    ///< 11, 12
void add_diffusion_figures(const Study& study, std::vector<Figure>& figures);     ///< 8 to 10
void add_structure_figures(const Study& study, std::vector<Figure>& figures);     ///< 14 to 17
void add_mobility_figures(const Study& study, std::vector<Figure>& figures);      ///< 18 to 22
void add_flow_figures(const Study& study, std::vector<Figure>& figures);          ///< 23, 24

}  // namespace sandglass
