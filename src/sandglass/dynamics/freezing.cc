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

/// When disk i, on its present flight, can be touched by a frozen one of its list at the earliest.
double Strip::earliest_touch_of_listed(std::uint32_t i) const {
  const Record& disk = records_[i];
  const Vector x = Vector::all(disk.x), y = Vector::all(disk.y), vx = Vector::all(disk.vx), vy = Vector::all(disk.vy);
  const Vector time = Vector::all(disk.time), radius = Vector::all(disk.radius), zero = Vector::all(0);
  const Window& window = tables_->window;
  double earliest = never;
  for (std::uint32_t first = 0; first < disk.neighbour_count; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list_from(i, first);
    Vector other[8];  // columns of the record: x, y, vx, vy, time, next_time, radius
    load_columns(records_, list, other);
    const Mask frozen = (Vector::all(nobodys) < other[5]) & (other[5] < zero);
    if (frozen.lanes() == 0) continue;
    const Vector start = Vector::all(window.start - 1) - other[5], t = max(time, start);
    const Vector flight = t - time, ghost_flight = start - other[4];
    const Vector rx = nearest(fma(vx, flight, x) - fma(other[2], ghost_flight, other[0]), box_);
    const Vector ry = nearest(fma(vy, flight, y) - fma(other[3], ghost_flight, other[1]), box_);
    const Mask is_big = other[6] == Vector::all(tables_->state.mixture.radius[big]);
    const Vector speed = choose(is_big, Vector::all(window.top_speed[big]), Vector::all(window.top_speed[small]));
    const Vector touch = touch_times(t, start, rx, ry, vx, vy, radius + other[6], speed);
    earliest = std::fmin(earliest, smallest(choose(frozen, touch, Vector::all(never))));
  }
  return earliest;
}

/// Calls visit(k, t) for every known disk k of the list of the frozen disk i, which it can touch at t at the earliest.
template <class Visit>
[[gnu::always_inline]] inline void Strip::visit_touched(std::uint32_t i, Visit&& visit) const {
  const Record& ghost = records_[i];
  const double started = since(ghost);
  const Position at = position_at(ghost, started);
  const Vector x = Vector::all(at.x), y = Vector::all(at.y), start = Vector::all(started), zero = Vector::all(0);
  const Vector radius = Vector::all(ghost.radius), speed = Vector::all(tables_->window.top_speed[ghost.species]);
  for (std::uint32_t first = 0; first < ghost.neighbour_count; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list_from(i, first);
    Vector other[8];
    load_columns(records_, list, other);
    const Vector t = max(other[4], start), flight = t - other[4];
    const Vector rx = nearest(fma(other[2], flight, other[0]) - x, box_);
    const Vector ry = nearest(fma(other[3], flight, other[1]) - y, box_);
    alignas(64) double touch[Vector::width];
    touch_times(t, start, rx, ry, other[2], other[3], radius + other[6], speed).store(touch);
    for (unsigned known = (zero <= other[5]).lanes(); known != 0; known &= known - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(known));
      visit(list[lane], touch[lane]);
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

double Strip::earliest_touch_of_listed(std::uint32_t i) const {
  double earliest = never;
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n)
    if (const Record& other = records_[neighbours_.listed(i, n)]; is_frozen(other))
      earliest = std::fmin(earliest, earliest_touch(records_[i], other));
  return earliest;
}

template <class Visit>
[[gnu::always_inline]] inline void Strip::visit_touched(std::uint32_t i, Visit&& visit) const {
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n)
    if (const std::uint32_t k = neighbours_.listed(i, n); !is_frozen(records_[k]))
      visit(k, earliest_touch(records_[k], records_[i]));
}

#endif

/// When disk i, on its present flight, must be frozen; never if not in this window.
double Strip::freezing_time(std::uint32_t i) {
  if (!first_pass_) {
    check_speed(records_[i]);
    if (!frozen_about_) return never;
  }
  const double earliest = earliest_touch_of_listed(i);
  return earliest <= tables_->window.end ? earliest : never;
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
    failed_ = too_deep_ = true;
    end_ = tables_->window.start;  // stops the loop
  }
  check_speed(disk);
  expect_kick(i);
  visit_touched(i, [this](std::uint32_t k, double touch) {
    if (is_done(k)) return;  // with this window, and never met in it
    concern(k);
    freeze_no_later(k, touch);
  });
}

/// From now on disk i must look out for frozen ones.
void Strip::concern(std::uint32_t i) {
  if (records_[i].concerned) return;
  records_[i].concerned = true;
  concerned_.push_back(i);
}

void Strip::concern_if_beside_frozen(std::uint32_t i) {
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n)
    if (is_frozen(records_[neighbours_.listed(i, n)])) return concern(i);
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
  failed_ = too_fast_ = true;
  end_ = tables_->window.start;  // stops the loop
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
    concern_if_beside_frozen(i);
    if (!records_[i].concerned) return;
    const Record& disk = records_[i];
    if (disk.partner != no_disk && is_frozen(records_[disk.partner]))
      lose_partner(i, disk.next_time, disk.next == Next::contact_entered_by_partner);
    freeze_no_later(i, freezing_time(i));
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
