#include "sandglass/prepare/check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/prepare/grid.h"
#include "sandglass/prepare/periodic.h"

namespace sandglass {
namespace {

bool is_positive(double value) { return value > 0 && std::isfinite(value); }

void check_mixture(const Mixture& mixture) {
  for (int species = 0; species < species_count; ++species) {
    if (is_positive(mixture.radius[species]) && is_positive(mixture.mass[species])) continue;
    throw InputError(
        fmt::format("the {} disks have radius {} and mass {}, but both must be positive numbers: check the size ratio",
                    species == small ? "small" : "big", mixture.radius[species], mixture.mass[species]));
  }
}

void check_box(double box_length, const Mixture& mixture) {
  const double least = minimum_box_length(mixture);
  // A box made exactly as wide as the least one may come out an ulp short.
  if (box_length >= least * (1 - 1e-12) && std::isfinite(box_length)) return;
  throw InputError(fmt::format(
      "the box is {:.6g} R_s wide, but an exact run needs at least 8 R_b = {:.6g}, so that the nearest images of two "
      "disks stay the nearest: take more particles or a lower packing fraction",
      box_length, least));
}

}  // namespace

double checked_box_length(const Mixture& mixture, std::size_t small_count, std::size_t big_count,
                          double packing_fraction) {
  if (small_count + big_count < 2) {
    throw InputError(fmt::format("{} particles cannot collide: take at least 2", small_count + big_count));
  }
  check_mixture(mixture);
  if (!is_positive(packing_fraction)) {
    throw InputError(fmt::format("the packing fraction is {}, but must be a positive number", packing_fraction));
  }
  const double box_length = box_length_for(mixture, small_count, big_count, packing_fraction);
  check_box(box_length, mixture);
  return box_length;
}

Overlap deepest_overlap(const State& state) {
  const double box = state.box_length;
  const auto& radius = state.mixture.radius;
  Grid grid(box, 2 * *std::max_element(radius.begin(), radius.end()), state.size());
  Overlap deepest;
  for (std::uint32_t id = 0; id < state.size(); ++id) {
    const Disk& disk = state.disks[id];
    grid.visit_near(disk.x, disk.y, [&](std::uint32_t other_id) {
      const Disk& other = state.disks[other_id];
      const double dx = nearest_image(disk.x - other.x, box), dy = nearest_image(disk.y - other.y, box);
      const double contact = radius[disk.species] + radius[other.species];
      const double depth = 1 - std::sqrt(dx * dx + dy * dy) / contact;
      if (depth > deepest.depth) deepest = {depth, other_id, id};
      return true;
    });
    grid.add(id, disk.x, disk.y);
  }
  return deepest;
}

void check_no_overlap(const State& state) {
  check_mixture(state.mixture);
  check_box(state.box_length, state.mixture);
  for (std::size_t id = 0; id < state.size(); ++id) {
    const Disk& disk = state.disks[id];
    const auto inside = [&](double coordinate) { return coordinate >= 0 && coordinate < state.box_length; };
    if (inside(disk.x) && inside(disk.y)) continue;
    throw InputError(fmt::format(
        "disk {} is at ({}, {}), outside the box [0, {:.6g}): check the units and the box of the start state", id,
        disk.x, disk.y, state.box_length));
  }
  const Overlap deepest = deepest_overlap(state);
  if (deepest.depth <= touching_tolerance) return;
  throw InputError(fmt::format(
      "disks {} and {} overlap by {:.3g} of their contact distance, but hard disks cannot: check the radii and the box "
      "of the start state, or lower the packing fraction",
      deepest.first, deepest.second, deepest.depth));
}

}  // namespace sandglass
