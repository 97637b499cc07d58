// Whom a kick's counter-kick goes to.
#include <cmath>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// The disk with the smallest gap of surfaces to disk i at time t; the smaller id at equal gaps.
std::uint32_t IsaEngine::nearest_partner(std::uint32_t i, double t) {
  const Record& disk = records_[i];
  double best_gap = never;
  std::uint32_t best = no_disk;
  auto visit = [&](std::uint32_t k) {
    if (k == i) return;
    const double gap = surface_gap(disk, records_[k], disk.radius + records_[k].radius, t, box_);
    if (gap < best_gap || (gap == best_gap && best != no_disk && cold_[k].id < cold_[best].id)) {
      best_gap = gap;
      best = k;
    }
  };
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) visit(list[n]);

  // Unlisted disks have list centres at least R_i + R_j + 2 leash from ours; each of the two has moved from its own.
  const double x = std::fma(disk.vx, t - disk.time, disk.x), y = std::fma(disk.vy, t - disk.time, disk.y);
  const Grid& grid = neighbours_.grid();
  const double dx = grid.offset(cold_[i].centre.x, x), dy = grid.offset(cold_[i].centre.y, y);
  const double moved = std::sqrt(dx * dx + dy * dy);
  if (best_gap < leash_ - moved) return best;

  ++bookkeeping.wide_partner_searches;
  const double margin = disk.radius + largest_radius() + leash_ + 1e-9;
  for (double radius = margin + 2 * leash_;; radius *= 1.5) {
    if (best != no_disk && best_gap + margin < radius) radius = best_gap + margin;
    const bool all = neighbours_.grid().visit_near(x, y, radius, visit);
    if (all || best_gap + margin <= radius) return best;
  }
}

/// One of the disks whose centres are within reach * (R_i + R_j) of disk i at time t, picked by the kick's own random
/// number in the order of ids; no_disk if there are none.
std::uint32_t IsaEngine::partner_within_reach(std::uint32_t i, double t, const Kick& kick) {
  const Record& disk = records_[i];
  candidates_.clear();
  auto visit = [&](std::uint32_t k) {
    if (k == i) return;
    if (!within_reach(disk, records_[k], disk.radius + records_[k].radius, state_.drive.reach, t, box_)) return;
    candidates_.push_back({cold_[k].id, k});
  };
  const double x = std::fma(disk.vx, t - disk.time, disk.x), y = std::fma(disk.vy, t - disk.time, disk.y);
  const double radius = state_.drive.reach * (disk.radius + largest_radius()) + leash_ + 1e-9;
  neighbours_.grid().visit_near(x, y, radius, visit);
  if (candidates_.empty()) return no_disk;
  return nth_by_id(candidates_.begin(), candidates_.end(), kick.pick(candidates_.size())).slot;
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
