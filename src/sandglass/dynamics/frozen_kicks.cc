// Pair kicks in a window. A frozen disk's clock tells when it kicks, but not from where: then all disks that may be its
// nearest are frozen. And a known disk does not kick, but is frozen, where a frozen one may be nearest to it.
#include <algorithm>
#include <cmath>

#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Gap of disk i on its present flight at time t and disk k at t_k.
double Strip::gap_at(std::uint32_t i, double t, std::uint32_t k, double t_k) const {
  const Record &a = records_[i], &b = records_[k];
  const Position at_a = position_at(a, t), at_b = position_at(b, t_k);
  const double rx = box_.nearest(at_b.x - at_a.x), ry = box_.nearest(at_b.y - at_a.y);
  return std::sqrt(rx * rx + ry * ry) - (a.radius + b.radius);
}

/// In a later pass: whether disk k has been known at time t in an earlier one. Where it was then may be forgotten; but
/// it was not near a disk that kicked at time t, or it would have been frozen by then.
bool Strip::is_done_at(std::uint32_t k, double t) const {
  if (first_pass_) return false;
  return is_done(k) || records_[k].time > t || (is_frozen(records_[k]) && since(records_[k]) > t);
}

/// How far a frozen disk may have come until time t, and a bit.
double Strip::growth(std::uint32_t frozen_disk, double t) const {
  return tables_->window.top_speed[records_[frozen_disk].species] * (t - since(records_[frozen_disk])) +
         1e-9 * box_.length;
}

/// The events of the window, and what happens to disks when the clocks of frozen ones ring.
void Strip::run_window() {
  const double end = tables_->window.end;
  while (!failed_) {
    const double ring = frozen_kicks_.empty() ? never : frozen_kicks_[0].time;
    run(std::fmin(end, std::nextafter(ring, -never)));
    if (failed_ || frozen_kicks_.empty()) return;
    if (frozen_kicks_[0].time < ring) continue;  // a disk has been frozen meanwhile, and the loop has stopped early
    const FrozenKick kick = frozen_kicks_[0];
    std::pop_heap(frozen_kicks_.begin(), frozen_kicks_.end());
    frozen_kicks_.pop_back();
    on_frozen_kick(kick);
    const double wait = Kick::draw_wait(tables_->state.seed, ids_[kick.slot], kick.count);
    const double next = kick.time + wait / clock_rate(tables_->state.drive);
    if (next > end) continue;
    frozen_kicks_.push_back({next, kick.count + 1, kick.slot});
    std::push_heap(frozen_kicks_.begin(), frozen_kicks_.end());
  }
}

void Strip::expect_kick(std::uint32_t frozen_disk) {
  const double next_kick = cold_[frozen_disk].next_kick;
  if (tables_->state.drive.kind != DriveKind::pair || next_kick > tables_->window.end) return;
  frozen_kicks_.push_back({next_kick, cold_[frozen_disk].kick_count + 1, frozen_disk});
  std::push_heap(frozen_kicks_.begin(), frozen_kicks_.end());
  end_ = std::fmin(end_, std::nextafter(next_kick, -never));
}

/// Freezes every disk that may be nearest to a frozen one at its kick: those to which the gap may be as small as the
/// largest that its nearest neighbour can have.
void Strip::on_frozen_kick(const FrozenKick& kick) {
  const std::uint32_t u = kick.slot;
  const Record& disk = records_[u];
  const double t = kick.time, start = since(records_[u]), grown = growth(u, t);
  double nearest = never;  // no nearer one has a larger gap
  auto bound = [&](std::uint32_t k) {
    if (k == u || is_done_at(k, t)) return;
    if (is_frozen(records_[k]))
      nearest = std::fmin(nearest, gap_at(u, start, k, since(records_[k])) + grown + growth(k, t));
    else
      nearest = std::fmin(nearest, gap_at(u, start, k, t) + grown);
  };
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) bound(neighbours_.listed(u, n));

  const Grid& grid = neighbours_.grid();
  const auto [x, y] = position_at(disk, start);
  const double bodies = disk.radius + largest_radius();
  if (!whole_) {  // another strip cannot know of this kick: it must not reach there
    const double room = grid.height(lane_ / 2) - leash_[true];
    auto within_room = [&] { return nearest + grown + bodies + leash_[true] < room; };
    if (!within_room()) grid.visit_near(x, y, room, bound);  // in a dilute system lists may be empty
    if (!within_room()) {
      give_up();
      return;
    }
  }
  suspects_.clear();
  auto suspect = [&](std::uint32_t k) {
    if (k == u || is_done_at(k, t) || is_frozen(records_[k])) return;
    if (gap_at(u, start, k, t) - grown <= nearest) suspects_.push_back(k);
  };
  const double dx = grid.offset(cold_[u].centre.x, x), dy = grid.offset(cold_[u].centre.y, y);
  // Unlisted disks have list centres at least a skin beyond contact from the frozen one's.
  const double unlisted = leash_[false] + tables_->window.way - std::sqrt(dx * dx + dy * dy) - grown;
  if (nearest < unlisted)
    for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) suspect(neighbours_.listed(u, n));
  else
    grid.visit_near(x, y, nearest + grown + bodies + leash_[true] + 1e-9, suspect);
  for (const std::uint32_t k : suspects_) freeze(k, t);
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
