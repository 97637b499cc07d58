#include "sandglass/observe/bond_order.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "sandglass/observe/cells.h"

namespace sandglass {
namespace {

constexpr std::uint32_t no_neighbour = 0xffffffffu;

// A convex cell around its disk at the origin; the side from corner k to the next one is shared with `neighbour`
// (an index into the candidates).
struct Corner {
  double x, y;
  std::uint32_t neighbour;
};

// Keeps the part of `cell` with n.p <= h, n the unit vector (nx, ny); the new side belongs to `neighbour`. Returns
// whether anything was cut off.
bool clip(std::vector<Corner>& cell, std::vector<Corner>& scratch, double nx, double ny, double h,
          std::uint32_t neighbour) {
  if (std::none_of(cell.begin(), cell.end(), [&](const Corner& c) { return nx * c.x + ny * c.y - h > 0; }))
    return false;
  scratch.clear();
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const Corner& a = cell[k];
    const Corner& b = cell[(k + 1) % cell.size()];
    const double above_a = nx * a.x + ny * a.y - h, above_b = nx * b.x + ny * b.y - h;
    if (above_a <= 0) scratch.push_back(a);
    if ((above_a <= 0) == (above_b <= 0)) continue;
    const double t = above_a / (above_a - above_b);
    const bool leaving = above_a <= 0;
    scratch.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), leaving ? neighbour : a.neighbour});
  }
  cell.swap(scratch);
  return true;
}

// Signed distance from disk i to the side shared with a disk at distance d: |p|^2 - R_i^2 = |p - d|^2 - R_j^2.
double side_distance(double d, double radius, double other_radius) {
  return (d * d + radius * radius - other_radius * other_radius) / (2 * d);
}

double farthest_corner(const std::vector<Corner>& cell) {
  double squared = 0;
  for (const Corner& corner : cell) squared = std::max(squared, corner.x * corner.x + corner.y * corner.y);
  return std::sqrt(squared);
}

// Not from a C library, whose bits differ between machines.
double magnitude(std::complex<double> z) { return std::sqrt(z.real() * z.real() + z.imag() * z.imag()); }

std::complex<double> weighted_order(const std::vector<Corner>& cell, const std::vector<Cells::Neighbour>& near) {
  std::complex<double> sum = 0;
  double perimeter = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) {
    if (cell[k].neighbour == no_neighbour) continue;
    const Corner& next = cell[(k + 1) % cell.size()];
    const double length = magnitude({next.x - cell[k].x, next.y - cell[k].y});
    const Cells::Neighbour& neighbour = near[cell[k].neighbour];
    const auto direction = std::complex<double>(neighbour.dx, neighbour.dy) / std::sqrt(neighbour.squared());
    const auto square = direction * direction;
    sum += length * square * square * square;
    perimeter += length;
  }
  return perimeter > 0 ? sum / perimeter : 0;
}

}  // namespace

std::vector<std::complex<double>> bond_order(const Frame& frame, const Population& population) {
  std::vector<double> radius(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i)
    radius[population.order[i]] = population.mixture.radius[i < population.small_count ? small : big];
  const double largest = std::max(population.mixture.radius[small], population.mixture.radius[big]);
  const double half = population.box_length / 2;
  const double spacing = population.box_length / std::sqrt(static_cast<double>(frame.size()));
  const Cells cells(frame.x, frame.y, population.box_length, 1.5 * spacing);
  const double usual = 1.75 * spacing;  // within it are nearly always all that touch the cell
  const auto nearer = [](const auto& a, const auto& b) { return a.squared() < b.squared(); };

  std::vector<std::complex<double>> psi(frame.size());
  std::vector<Cells::Neighbour> near;
  std::vector<Corner> cell, scratch;
  for (std::uint32_t id = 0; id < frame.size(); ++id) {
    // Wider and wider, until no disk farther away can cut the cell.
    for (int rings = 1;; ++rings) {
      const double complete = cells.collect(id, rings, near);
      // By distance; the farther part is put in order only if it is needed.
      const auto farther =
          std::partition(near.begin(), near.end(), [&](const auto& n) { return n.squared() < usual * usual; });
      const auto usual_count = static_cast<std::size_t>(farther - near.begin());
      std::sort(near.begin(), farther, nearer);
      cell = {{-half, -half, no_neighbour},
              {half, -half, no_neighbour},
              {half, half, no_neighbour},
              {-half, half, no_neighbour}};
      double farthest = farthest_corner(cell);
      for (std::uint32_t k = 0; k < near.size(); ++k) {
        if (k == usual_count) {
          if (side_distance(usual, radius[id], largest) > farthest) break;
          std::sort(farther, near.end(), nearer);
        }
        const double d = std::sqrt(near[k].squared());
        if (side_distance(d, radius[id], largest) > farthest) break;
        const double h = side_distance(d, radius[id], radius[near[k].id]);
        if (clip(cell, scratch, near[k].dx / d, near[k].dy / d, h, k)) farthest = farthest_corner(cell);
      }
      if (std::isinf(complete) || side_distance(complete, radius[id], largest) > farthest) break;
    }
    psi[id] = weighted_order(cell, near);
  }
  return psi;
}

double global_bond_order(const std::vector<std::complex<double>>& psi) {
  std::complex<double> sum = 0;
  for (const auto& value : psi) sum += value;
  return psi.empty() ? 0 : magnitude(sum) / static_cast<double>(psi.size());
}

double local_bond_order(const std::vector<std::complex<double>>& psi) {
  double sum = 0;
  for (const auto& value : psi) sum += magnitude(value);
  return psi.empty() ? 0 : sum / static_cast<double>(psi.size());
}

}  // namespace sandglass
