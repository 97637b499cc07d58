// Whom a kick's counter-kick goes to.
#include <algorithm>
#include <cmath>

#include "sandglass/dynamics/simd.h"
#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

#ifdef SANDGLASS_SIMD
/// surface_gap to one block of a list, lane by lane, the same operations in the same order: the smallest, and where.
Smallest Strip::smallest_gap(const Record& disk, const std::uint32_t* list, double t) const {
  const Position at = position_at(disk, t);
  const Vector x = Vector::all(at.x), y = Vector::all(at.y);
  Vector other[8];  // columns of the record: x, y, vx, vy, time, next_time, radius
  load_columns(records_, list, other);
  const Vector other_flight = Vector::all(t) - other[4];
  const Vector rx = nearest(fma(other[2], other_flight, other[0]) - x, box_);
  const Vector ry = nearest(fma(other[3], other_flight, other[1]) - y, box_);
  const Vector gap = sqrt(fma(rx, rx, ry * ry)) - (Vector::all(disk.radius) + other[6]);
  const Mask somebody = Vector::all(nobodys) < other[5];  // not the record that fills up lists
  const Vector candidate = choose(somebody, gap, Vector::all(never));
  const double smallest_of_all = smallest(candidate);
  return {smallest_of_all, (candidate == Vector::all(smallest_of_all)).lanes()};
}

/// Of the first block of the list, frozen disks apart, who is nearest to disk i at time t; any of them at equal gaps.
Strip::Nearest Strip::nearest_listed(std::uint32_t i, double t) const {
  const std::uint32_t* const list = neighbours_.list(i);
  Nearest nearest{no_disk, never};
  for (std::uint32_t first = 0; first < Neighbours::block; first += Vector::width) {
    const auto [gap, lanes] = smallest_gap(records_[i], list + first, t);
    if (gap < nearest.gap) nearest = {list[first + static_cast<unsigned>(__builtin_ctz(lanes))], gap};
  }
  return nearest;
}
#else
Strip::Nearest Strip::nearest_listed(std::uint32_t, double) const { return {no_disk, never}; }
#endif

/// Unlisted disks have list centres at least R_i + R_j + skin from that of disk i, and have moved from there by half
/// the skin at most; or, where some may be frozen and are on the short leash, by that and the way of a frozen one.
bool Strip::nobody_unlisted_within(double gap, std::uint32_t i, double t) const {
  const auto [x, y] = position_at(records_[i], t);
  const Grid& grid = neighbours_.grid();
  const double dx = grid.offset(cold_[i].centre.x, x), dy = grid.offset(cold_[i].centre.y, y);
  return gap < leash_[records_[i].roomy] - std::sqrt(dx * dx + dy * dy);
}

/// The disk with the smallest gap of surfaces to disk i at time t; the smaller id at equal gaps. In a window: among
/// those that are known, or undecided where a frozen one may be nearer, or one of which another strip alone knows.
std::uint32_t Strip::nearest_partner(std::uint32_t i, double t) {
  const Record& disk = records_[i];
  double best_gap = never, rival_gap = never;
  std::uint32_t best = no_disk;
  auto visit = [&](std::uint32_t k) {
    if (k == i || is_done_at(k, t)) return;
    if (is_frozen(records_[k])) {
      rival_gap = std::fmin(rival_gap, gap_at(i, t, k, since(records_[k])) - growth(k, t));
      return;
    }
    const double gap = surface_gap(disk, records_[k], disk.radius + records_[k].radius, t, box_);
    if (gap < best_gap || (gap == best_gap && best != no_disk && ids_[k] < ids_[best])) {
      best_gap = gap;
      best = k;
    }
  };
  auto visit_listed = [&](std::uint32_t first, std::uint32_t last) {
    for (; first < last; ++first) visit(neighbours_.listed(i, first));
  };
#ifdef SANDGLASS_SIMD
  const bool no_frozen_one_listed = !disk.concerned;
  for (std::uint32_t first = 0; no_frozen_one_listed && first < disk.neighbour_count; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list_from(i, first);
    const auto [gap, lanes] = smallest_gap(disk, list, t);
    if (gap > best_gap) continue;
    if (gap < best_gap && (lanes & (lanes - 1)) == 0) [[likely]]
      best_gap = gap, best = list[static_cast<unsigned>(__builtin_ctz(lanes))];
    else  // ties are for the rule
      visit_listed(first, std::min<std::uint32_t>(first + Vector::width, disk.neighbour_count));
  }
  if (!no_frozen_one_listed) visit_listed(0, disk.neighbour_count);
#else
  visit_listed(0, disk.neighbour_count);
#endif

  if (!nobody_unlisted_within(best_gap, i, t)) {
    const auto [x, y] = position_at(disk, t);
    const Grid& grid = neighbours_.grid();
    ++bookkeeping_.wide_partner_searches;
    const double margin = disk.radius + largest_radius() + leash_[true] + tables_->window.way + 1e-9;
    const double room = whole_ ? never : grid.height(lane_) - leash_[true];  // what lies beyond is another strip's
    for (double radius = margin + 2 * leash_[true];; radius *= 1.5) {
      if (best != no_disk && best_gap + margin < radius) radius = best_gap + margin;
      if (!(radius < room)) return undecided;
      const bool all = grid.visit_near(x, y, radius, visit);
      if (all || best_gap + margin <= radius) break;
    }
  }
  return rival_gap <= best_gap && rival_gap < never ? undecided : best;
}

/// One of the disks whose centres are within reach * (R_i + R_j) of disk i at time t, picked by the kick's own random
/// number in the order of ids; no_disk if there are none.
std::uint32_t Strip::partner_within_reach(std::uint32_t i, double t, const Kick& kick) {
  const Record& disk = records_[i];
  candidates_.clear();
  auto visit = [&](std::uint32_t k) {
    if (k == i) return;
    if (!within_reach(disk, records_[k], disk.radius + records_[k].radius, tables_->state.drive.reach, t, box_)) return;
    candidates_.push_back({ids_[k], k});
  };
  const auto [x, y] = position_at(disk, t);
  const double radius = tables_->state.drive.reach * (disk.radius + largest_radius()) + leash_[true] + 1e-9;
  neighbours_.grid().visit_near(x, y, radius, visit);
  if (candidates_.empty()) return no_disk;
  return nth_by_id(candidates_.begin(), candidates_.end(), kick.pick(candidates_.size())).slot;
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
