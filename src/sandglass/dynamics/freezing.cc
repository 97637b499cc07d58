// Where several threads work, each strip does the events of its own disks. What becomes of the disks between the strips
// is unknown until the next pass: they are frozen from the start of the window on. A frozen disk may be anywhere within
// top_speed times the time since, so it may touch a known disk no earlier than such a growing disk does; then that is
// frozen, too. So is a disk whose event would reach into what another thread works on. Freezing is always right: a
// frozen disk's record stays as its last event left it, and a later pass goes on from there.
#include <cmath>

#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// When a known disk on its present flight can be touched by a frozen one at the earliest. With n the direction from
/// where the other was frozen, the disk moves away from it at v.n or faster, while the other follows at top_speed.
double Strip::earliest_touch(const Record& disk, std::uint32_t ghost) const {
  const Record& other = records_[ghost];
  const double start = since(ghost), t = disk.time > start ? disk.time : start;
  const Position at = position_at(disk, t), other_at = position_at(other, start);
  const double rx = box_.nearest(at.x - other_at.x), ry = box_.nearest(at.y - other_at.y);
  const double distance = std::sqrt(rx * rx + ry * ry), contact = disk.radius + other.radius;
  const double speed = tables_->window.top_speed[other.species];
  const double room = distance - contact * (1 + 1e-9) - speed * (t - start);  // 1e-9: more than all rounding
  if (!(room > 0)) return t;
  const double closing = speed - (rx * disk.vx + ry * disk.vy) / distance;
  return closing > 0 ? t + room / closing : never;
}

/// When disk i, on its present flight, must be frozen; never if not in this window.
double Strip::freezing_time(std::uint32_t i) {
  const Record& disk = records_[i];
  if (!first_pass_) {
    check_speed(disk);
    if (!frozen_about_) return never;
  }
  double earliest = never;
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n)
    if (is_frozen(records_[list[n]])) earliest = std::fmin(earliest, earliest_touch(disk, list[n]));
  return earliest <= tables_->window.end ? earliest : never;
}

void Strip::freeze(std::uint32_t i, double t) {
  Record& disk = records_[i];
  if (disk.partner != no_disk) part(disk.partner);
  set_next(disk, frozen, Next::freeze, no_disk);
  const double after = (t - tables_->window.start) * (1 - 1e-6);  // so that it is not rounded up
  cold_[i].frozen_at = after > 0 ? static_cast<float>(after) : 0;
  left_.push_back({i, row(i)});
  frozen_about_ = true;
  check_speed(disk);
  expect_kick(i);
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
    const std::uint32_t k = list[n];
    if (is_frozen(records_[k])) continue;
    if (is_done(k)) continue;  // with this window, and never met in it
    concern(k);
    freeze_no_later(k, earliest_touch(records_[k], i));
  }
}

/// From now on disk i must look out for frozen ones.
void Strip::concern(std::uint32_t i) {
  if (cold_[i].frozen_at == concerned) return;
  cold_[i].frozen_at = concerned;
  concerned_.push_back(i);
}

void Strip::concern_if_beside_frozen(std::uint32_t i) {
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n)
    if (is_frozen(records_[list[n]])) return concern(i);
}

void Strip::freeze_no_later(std::uint32_t i, double t) {
  Record& disk = records_[i];
  if (t >= disk.next_time || t > tables_->window.end) return;
  if (disk.partner != no_disk) part(disk.partner);
  set_next(disk, t, Next::freeze, no_disk);
  enter_event(t, i);
}

/// What lies ahead of a frozen disk is bounded by its top speed. A faster one, or one that becomes faster in a later
/// pass, voids the window.
void Strip::check_speed(const Record& disk) {
  const double top = tables_->window.top_speed[disk.species];
  if (disk.vx * disk.vx + disk.vy * disk.vy <= top * top) [[likely]]
    return;
  failed_ = too_fast_ = true;
  end_ = tables_->window.start;  // stops the loop
}

void Strip::freeze_rows(Rows rows) {
  begin_pass();
  neighbours_.grid().visit_rows(rows.first, rows.count, [&](std::uint32_t i) {
    set_next(records_[i], frozen, Next::freeze, no_disk);
    cold_[i].frozen_at = 0;
    left_.push_back({i, row(i)});
    check_speed(records_[i]);
  });
}

void Strip::begin_pass() {
  neighbours_.refresh();
  left_.clear();
  frozen_kicks_.clear();
  failed_ = too_fast_ = false;
  until_stall_check_ = 1;
  progress_time_ = -never;
}

/// The disks of the outer rows look which of their neighbours are frozen.
void Strip::first_pass() {
  auto look_out = [this](std::uint32_t i) {
    concern_if_beside_frozen(i);
    if (cold_[i].frozen_at == unconcerned) return;
    const std::uint32_t partner = records_[i].partner;
    if (partner != no_disk && is_frozen(records_[partner])) part(i);
    freeze_no_later(i, freezing_time(i));
  };
  const std::uint32_t lower = core_.count < reach_ ? core_.count : reach_;
  const std::uint32_t upper = core_.count - lower < reach_ ? core_.count - lower : reach_;
  neighbours_.grid().visit_rows(core_.first, lower, look_out);
  neighbours_.grid().visit_rows((core_.first + core_.count - upper) % core_.side, upper, look_out);
  if (tables_->state.drive.kind == DriveKind::pair) {  // of the lanes, half belongs to this strip
    auto expect = [this](std::uint32_t i) { expect_kick(i); };
    neighbours_.grid().visit_rows((core_.first + core_.count) % core_.side, lane_ - lane_ / 2, expect);
    neighbours_.grid().visit_rows((core_.first + core_.side - (lane_ - lane_ / 2)) % core_.side, lane_ - lane_ / 2,
                                  expect);
  }
  run_window();
  end_pass();
}

void Strip::begin_later_pass() {
  begin_pass();
  first_pass_ = false;
  frozen_about_ = false;
  resumed_ = 0;
  outbox_.clear();
  outbox_from_ = tables_->window.end;
  calendar_.skip_to(tables_->window.start);
}

void Strip::resume(const Strip& other) {
  auto beyond = [this](std::uint32_t rows) {
    return Rows{(core_.first + core_.side - rows) % core_.side, core_.count + 2 * rows, core_.side};
  };
  const Rows met = beyond(reach_), kicking = beyond(lane_ - lane_ / 2);  // half of a lane belongs to this strip
  for (const Left& disk : other.left_) {
    if (!whole_ && !core_.hold(disk.row)) {
      if (met.hold(disk.row)) frozen_about_ = true;
      if (kicking.hold(disk.row)) expect_kick(disk.slot);
    } else if (is_frozen(records_[disk.slot])) {
      set_next(records_[disk.slot], never, Next::review, no_disk);
      concern(disk.slot);
      enter_next_kick(disk.slot);
      ++resumed_;
    }
  }
}

/// All disks that take part are concerned: their speed is checked at every event. The others are done with this window;
/// their records are those of its end, and what is foreseen with them lies beyond it.
void Strip::later_pass() {
  for (std::uint32_t n = 0; n < resumed_; ++n) {
    if (n + 16 < resumed_) fetch_disk(concerned_[n + 16]);
    if (n + 8 < resumed_) fetch_neighbours(concerned_[n + 8]);
    predict(concerned_[n]);
  }
  run_window();
  end_pass();
  (whole_ ? bookkeeping_.left_over : bookkeeping_.frozen) += resumed_;
}

void Strip::end_pass() {
  for (const std::uint32_t i : concerned_)
    if (!is_frozen(records_[i])) cold_[i].frozen_at = unconcerned;
  concerned_.clear();
}

void Strip::remake_calendar() {
  calendar_.clear();
  neighbours_.refresh();
  neighbours_.grid().visit_rows(core_.first, core_.count, [this](std::uint32_t i) { enter_calendar(i); });
}

void Strip::take_over(const Strip& other) {
  for (const Entry& entry : other.outbox_)
    if (owns(entry.slot) && (records_[entry.slot].next_time == entry.time || cold_[entry.slot].next_kick == entry.time))
      calendar_.push(entry.time, entry.slot);
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
