// Where several threads work, each strip does the events of its own disks. What becomes of the disks between the strips
// is unknown until the next pass: they are frozen from the start of the window on. A frozen disk may be anywhere within
// top_speed times the time since, so it may touch a known disk no earlier than such a growing disk does; then that is
// frozen, too. So is a disk whose event would reach into what another thread works on. Freezing is always right: a
// frozen disk's record stays as its last event left it, and a later pass goes on from there.
#include <cmath>

#include "sandglass/dynamics/simd.h"
#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

inline constexpr double beyond_rounding = 1 + 1e-9;  // contact distances are longer by more than all rounding

#ifdef SANDGLASS_SIMD

/// When known disks on their present flights can be touched by frozen ones (ghosts) at the earliest: t, or later. (rx,
/// ry) is where the disk is at time t from where the ghost was when it was frozen, at its start. With n the direction
/// of that, the disk moves away at v.n or faster, while the ghost follows at top_speed.
[[gnu::always_inline]] inline Vector touch_times(Vector t, Vector start, Vector rx, Vector ry, Vector vx, Vector vy,
                                                 Vector contact, Vector speed) {
  const Vector zero = Vector::all(0), distance = sqrt(fma(rx, rx, ry * ry));
  const Vector room = distance - fma(contact, Vector::all(beyond_rounding), speed * (t - start));
  const Vector closing = speed - fma(rx, vx, ry * vy) / distance;
  const Vector later = choose(zero < closing, t + room / closing, Vector::all(never));
  return choose(zero < room, later, t);
}

Strip::Menace Strip::menace(std::uint32_t i) const {
  const Record& disk = records_[i];
  const Vector x = Vector::all(disk.x), y = Vector::all(disk.y), vx = Vector::all(disk.vx), vy = Vector::all(disk.vy);
  const Vector time = Vector::all(disk.time), radius = Vector::all(disk.radius), zero = Vector::all(0);
  const Window& window = tables_->window;
  Menace menace;
  for (std::uint32_t first = 0; first < disk.neighbour_count; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list_from(i, first);
    Vector other[8];  // columns of the record: x, y, vx, vy, time, next_time, radius
    load_columns(records_, list, other);
    const Mask frozen = (Vector::all(nobodys) < other[5]) & (other[5] < zero);
    if (frozen.lanes() == 0) continue;
    menace.any = true;
    const Vector start = Vector::all(window.start - 1) - other[5], t = max(time, start);
    const Vector flight = t - time, ghost_flight = start - other[4];
    const Vector rx = nearest(fma(vx, flight, x) - fma(other[2], ghost_flight, other[0]), box_);
    const Vector ry = nearest(fma(vy, flight, y) - fma(other[3], ghost_flight, other[1]), box_);
    const Mask is_big = other[6] == Vector::all(tables_->state.mixture.radius[big]);
    const Vector speed = choose(is_big, Vector::all(window.top_speed[big]), Vector::all(window.top_speed[small]));
    const Vector touch = touch_times(t, start, rx, ry, vx, vy, radius + other[6], speed);
    menace.touch = std::fmin(menace.touch, smallest(choose(frozen, touch, Vector::all(never))));
  }
  return menace;
}

/// Of the list of the frozen disk i all known disks look out for it from now on, and are frozen where it can touch them
/// before what they have next.
void Strip::menace_listed(std::uint32_t i) {
  const Record& ghost = records_[i];
  const double started = since(ghost);
  const Position at = position_at(ghost, started);
  const Vector x = Vector::all(at.x), y = Vector::all(at.y), start = Vector::all(started), zero = Vector::all(0);
  const Vector radius = Vector::all(ghost.radius), speed = Vector::all(tables_->window.top_speed[ghost.species]);
  for (std::uint32_t first = 0; first < ghost.neighbour_count; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list_from(i, first);
    Vector other[8];
    load_columns(records_, list, other);
    const Mask known = zero <= other[5];
    if (known.lanes() == 0) continue;
    const Vector t = max(other[4], start), flight = t - other[4];
    const Vector rx = nearest(fma(other[2], flight, other[0]) - x, box_);
    const Vector ry = nearest(fma(other[3], flight, other[1]) - y, box_);
    const Vector touch = touch_times(t, start, rx, ry, other[2], other[3], radius + other[6], speed);
    const Mask sooner = known & (touch < other[5]) & (touch <= Vector::all(tables_->window.end));
    alignas(64) double times[Vector::width];
    touch.store(times);
    for (unsigned lanes = first_pass_ ? known.lanes() : 0; lanes != 0; lanes &= lanes - 1)
      concern(list[__builtin_ctz(lanes)]);
    for (unsigned lanes = sooner.lanes(); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
      if (!is_done(list[lane])) freeze_no_later(list[lane], times[lane]);  // others are never met in this window
    }
  }
}

#else

/// When a known disk on its present flight can be touched by a frozen one at the earliest (see touch_times above).
double Strip::earliest_touch(const Record& disk, const Record& ghost) const {
  const double start = since(ghost), t = disk.time > start ? disk.time : start;
  const Position at = position_at(disk, t), ghost_at = position_at(ghost, start);
  const double rx = box_.nearest(at.x - ghost_at.x), ry = box_.nearest(at.y - ghost_at.y);
  const double distance = std::sqrt(rx * rx + ry * ry), contact = disk.radius + ghost.radius;
  const double speed = tables_->window.top_speed[ghost.species];
  const double room = distance - contact * beyond_rounding - speed * (t - start);
  if (!(room > 0)) return t;
  const double closing = speed - (rx * disk.vx + ry * disk.vy) / distance;
  return closing > 0 ? t + room / closing : never;
}

Strip::Menace Strip::menace(std::uint32_t i) const {
  Menace menace;
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n) {
    const Record& other = records_[neighbours_.listed(i, n)];
    if (!is_frozen(other)) continue;
    menace.any = true;
    menace.touch = std::fmin(menace.touch, earliest_touch(records_[i], other));
  }
  return menace;
}

void Strip::menace_listed(std::uint32_t i) {
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n) {
    const std::uint32_t k = neighbours_.listed(i, n);
    if (is_frozen(records_[k]) || is_done(k)) continue;
    concern(k);
    freeze_no_later(k, earliest_touch(records_[k], records_[i]));
  }
}

#endif

/// When disk i, on its present flight, must be frozen; never if not in this window.
double Strip::freezing_time(std::uint32_t i) {
  if (!first_pass_) {
    check_speed(records_[i]);
    if (!frozen_about_) return never;
  }
  const double touch = menace(i).touch;
  return touch <= tables_->window.end ? touch : never;
}

void Strip::freeze(std::uint32_t i, double t) {
  Record& disk = records_[i];
  if (disk.partner != no_disk) leave_partner(disk);
  const double after = (t - tables_->window.start) * (1 - 1e-6) - 1e-15;  // so that it is not rounded up
  set_next(disk, frozen_after(after > 0 ? after : 0), Next::freeze, no_disk);
  records_[i].concerned = true;
  left_.push_back({i, row(i)});
  frozen_about_ = true;
  if (!whole_ && tables_->zone(row(i)) != Tables::Zone::near_lane) [[unlikely]] {
    too_deep_ = true;
    give_up();
  }
  check_speed(disk);
  expect_kick(i);
  menace_listed(i);
}

/// From now on disk i must look out for frozen ones.
void Strip::concern(std::uint32_t i) {
  if (records_[i].concerned) return;
  records_[i].concerned = true;
  concerned_.push_back(i);
}

/// A disk may have entries in the calendar of its home, which must be made anew before another strip has it.
void Strip::find_home(std::uint32_t i) {
  Record& disk = records_[i];
  const Home here = tables_->homes[row(i)];
  if (here == Home::none || here == disk.home) return;
  if (disk.home == Home::none)
    disk.home = here;
  else
    crossed_ = true;
}

void Strip::freeze_no_later(std::uint32_t i, double t) {
  Record& disk = records_[i];
  if (t >= disk.next_time || t > tables_->window.end) return;
  if (disk.partner != no_disk) leave_partner(disk);
  set_next(disk, t, Next::freeze, no_disk);
  enter_event(t, i);
}

/// What lies ahead of a frozen disk is bounded by its top speed. A faster one, or one that becomes faster in a later
/// pass, voids the window.
void Strip::check_speed(const Record& disk) {
  const double top = tables_->window.top_speed[disk.species];
  if (disk.vx * disk.vx + disk.vy * disk.vy <= top * top) [[likely]]
    return;
  too_fast_ = true;
  give_up();
}

/// Calls visit(slot) for every disk in these rows.
template <class Visit>
[[gnu::always_inline]] inline void Strip::visit(Rows rows, Visit&& visit) {
  for (std::uint32_t n = 0; n < rows.count; ++n) {
    in_row_.clear();
    neighbours_.grid().visit_rows((rows.first + n) % rows.side, 1, [this](std::uint32_t i) { in_row_.push_back(i); });
    for (std::size_t k = 0; k < in_row_.size(); ++k) {
      if (k + visits_ahead < in_row_.size()) fetch_visited(in_row_[k + visits_ahead]);
      visit(in_row_[k]);
    }
  }
}

void Strip::freeze_rows(Rows rows) {
  begin_pass();
  visit(rows, [&](std::uint32_t i) {
    set_next(records_[i], frozen_after(0), Next::freeze, no_disk);
    records_[i].concerned = true;
    left_.push_back({i, row(i)});
    check_speed(records_[i]);
  });
}

void Strip::begin_pass() {
  neighbours_.refresh();
  left_.clear();
  frozen_kicks_.clear();
  failed_ = too_fast_ = too_deep_ = false;
  until_stall_check_ = 1;
  progress_time_ = -never;
}

/// The disks of the outer rows look which of their neighbours are frozen.
void Strip::first_pass() {
  auto look_out = [this](std::uint32_t i) {
    const auto [any, touch] = menace(i);
    if (!any) return;
    concern(i);
    const Record& disk = records_[i];
    if (disk.partner != no_disk && is_frozen(records_[disk.partner]))
      lose_partner(i, disk.next_time, disk.next == Next::contact_entered_by_partner);
    freeze_no_later(i, touch);
  };
  const std::uint32_t lower = core_.count < reach_ ? core_.count : reach_;
  const std::uint32_t upper = core_.count - lower < reach_ ? core_.count - lower : reach_;
  visit({core_.first, lower, core_.side}, look_out);
  visit({(core_.first + core_.count - upper) % core_.side, upper, core_.side}, look_out);
  if (tables_->state.drive.kind == DriveKind::pair) {  // of the lanes, half belongs to this strip
    auto expect = [this](std::uint32_t i) { expect_kick(i); };
    const std::uint32_t half = lane_ - lane_ / 2;
    visit({(core_.first + core_.count) % core_.side, half, core_.side}, expect);
    visit({(core_.first + core_.side - half) % core_.side, half, core_.side}, expect);
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
  const bool kicked = tables_->state.drive.kind != DriveKind::none;
  const auto& left = other.left_;
  for (std::size_t n = 0; n < left.size(); ++n) {
    if (n + visits_ahead < left.size() && core_.hold(left[n + visits_ahead].row))
      fetch_visited(left[n + visits_ahead].slot);
    const auto [slot, row] = left[n];
    if (!whole_ && !core_.hold(row)) {
      if (met.hold(row)) frozen_about_ = true;
      if (kicking.hold(row)) expect_kick(slot);
    } else if (is_frozen(records_[slot])) {
      set_next(records_[slot], never, Next::review, no_disk);
      concerned_.push_back(slot);
      if (kicked) enter_next_kick(slot);
      ++resumed_;
    }
  }
}

/// All disks that take part are concerned: their speed is checked at every event. The others are done with this window;
/// their records are those of its end, and what is foreseen with them lies beyond it.
void Strip::later_pass() {
  for (std::uint32_t n = 0; n < resumed_; ++n) {
    if (n + 16 < resumed_) fetch_disk(concerned_[n + 16]);
    if (n + 8 < resumed_) fetch_listed(concerned_[n + 8]);
    if (n % 2 == 1) {  // two searches at a time: neither waits for the other
      const std::uint32_t i = concerned_[n - 1], j = concerned_[n];
      const Lanes of_i = first_contacts(i, Flight(records_[i]), no_disk),
                  of_j = first_contacts(j, Flight(records_[j]), no_disk);
      settle(i, of_i);
      settle(j, of_j);
    } else if (n + 1 == resumed_) {
      predict(concerned_[n]);
    }
  }
  run_window();
  end_pass();
  sift_outbox();
  (whole_ ? bookkeeping_.left_over : bookkeeping_.frozen) += resumed_;
}

/// Forgets what no longer comes, and notes in which row the others stand, while they are still near the processor.
void Strip::sift_outbox() {
  std::size_t kept = 0;
  for (const Entry entry : outbox_)
    if (records_[entry.slot].next_time == entry.time || cold_[entry.slot].next_kick == entry.time)
      outbox_[kept++] = {entry.time, entry.slot, row(entry.slot)};
  while (outbox_.size() > kept) outbox_.pop_back();
}

void Strip::end_pass() {
  for (const std::uint32_t i : concerned_)
    if (!is_frozen(records_[i])) records_[i].concerned = false;
  concerned_.clear();
}

void Strip::remake_calendar() {
  calendar_.clear();
  neighbours_.refresh();
  visit(core_, [this](std::uint32_t i) { enter_calendar(i); });
}

void Strip::take_over(const Strip& other) {
  for (const Entry& entry : other.outbox_)
    if (core_.hold(entry.row)) calendar_.push(entry.time, entry.slot);
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
