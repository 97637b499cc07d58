// One trajectory on several threads. Time is cut into windows, and the plane into strips of whole rows of the grid with
// lanes between them.
//  First pass: the disks in the lanes are frozen; the strips do the window's events side by side, and freeze what the
//    lanes may reach. A disk that is never frozen is done with the window.
//  Second pass: strips around the former lanes go on with the frozen disks, side by side again. What is near their own
//    borders, in the middle of the former strips, stays frozen.
//  Last pass: one thread does the rest, most often nothing.
// A strip sees what its disks have in their lists. In the first pass both strips beside a lane see its disks, and
// neither changes them: lanes are one such range wide (with pair kicks two at least, and each strip has half). In the
// second a strip changes lists, too, and the partners of the listed: four ranges, so that no two threads meet.
#include <algorithm>
#include <cmath>

#include "sandglass/dynamics/epoch.h"
#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

void IsaEngine::run(double end) {
  while (state_.now < end && strips_ > 1) {
    if (windows_since_kept_ >= windows_between_copies)
      keep();
    else if (temperature_has_changed())
      survey();
    const double windows = std::ceil((end - state_.now) / window_length());
    do_window(windows > 1 ? state_.now + (end - state_.now) / windows : end);
  }
  if (strips_ > 1) return;
  whole_.log = log;
  whole_.run(end);
  state_.now = end;
  hand_in();
}

/// As many strips as there are threads for, if they are high enough for the two passes to be worth it; one where what
/// is frozen in a window would take as long as what the threads save.
std::uint32_t IsaEngine::strips_for_threads(const Neighbours& neighbours) {
  if (!crew || (state_.drive.kind == DriveKind::pair && state_.drive.partner == PartnerRule::within)) return 1;
  const Grid& grid = neighbours.grid();
  lane_ = lane_rows(neighbours);
  const std::uint32_t wide_lane = grid.rows_within(4 * neighbours.longest_range());
  const std::uint32_t worth = tuning_.strip_rows > 0 ? tuning_.strip_rows : 3 * wide_lane;
  const std::uint32_t possible = (lane_ > wide_lane ? lane_ : wide_lane) + 2;
  std::uint32_t strips = grid.side() / (worth > possible ? worth : possible);
  if (strips > crew->size()) strips = crew->size();
  if (strips < 2) return 1;
  // The longer a window, the fewer disks are frozen at its start, and the more lists expire near the lanes, as (1 -
  // window_part)^-2.
  const double in_lanes = static_cast<double>(strips * lane_) / grid.side();
  window_part_ =
      tuning_.window_part > 0 ? tuning_.window_part : std::fmax(0.05, std::fmin(3 * std::sqrt(in_lanes), 0.4));
  if (tuning_.strip_rows > 0) return strips;
  // Per disk and window: in a dilute system, where it may not pay, about one and a half times the disks of the lanes
  // are frozen, and half the mean free times in a window are collisions, which take about as long.
  strips_ = strips;
  survey();
  const double collisions = 0.5 * window_length() * beats_per_epoch / state_.epoch_length;
  return strips / (1 + 1.5 * in_lanes / collisions) > 1.2 ? strips : 1;
}

/// Wide enough that no two strips have each other's disks in their lists; with pair kicks, that each has half of the
/// lane for itself and hardly a kick of a frozen disk may reach beyond that (see on_frozen_kick).
std::uint32_t IsaEngine::lane_rows(const Neighbours& neighbours) const {
  const Grid& grid = neighbours.grid();
  const double range = neighbours.longest_range();
  if (state_.drive.kind != DriveKind::pair) return grid.rows_within(range);
  // A gap is larger than G with a chance of about exp(-P A / T), P the pressure and A the area between two circles,
  // that of contact and one wider by G: what it costs to push all others out of there. Scaled-particle theory: P = n T
  // / (1 - eta)^2. A chance of 10^-9, and half as much again for clusters of inelastic disks.
  const auto& radius = state_.mixture.radius;
  const double contact = radius[small] + radius[big], largest = 2 * std::fmax(radius[small], radius[big]);
  double squares = 0;
  for (std::size_t i = 0; i < tables_.size; ++i) squares += tables_.records[i].radius * tables_.records[i].radius;
  const double box_area = tables_.box.length * tables_.box.length, eta = 3.14159 * squares / box_area;
  const double area = 1.5 * 20.7 * (1 - eta) * (1 - eta) * box_area / static_cast<double>(tables_.size);
  const double gap = std::sqrt(contact * contact + area / 3.14159) - contact;
  const double skin = tables_.neighbours.skin;  // two leashes and a way; another way for the growth of the two
  const std::uint32_t half = grid.rows_within(largest + 1.3 * skin + gap);
  const std::uint32_t apart = grid.rows_within(2 * range);
  return 2 * half > apart ? 2 * half : apart;
}

/// Where disks are on which leash. A frozen disk and another that is not in its list do not touch if both are on the
/// short one: the others within that range of where disks are frozen must be on it, too.
void IsaEngine::make_zones(const Neighbours& neighbours) {
  tables_.zones = {};
  if (strips_ == 1) return;
  const Grid& grid = neighbours.grid();
  if (freezing_depth_ == 0) freezing_depth_ = tuning_.freezing_depth;
  if (freezing_depth_ == 0) {
    // Freezing goes on from disk to disk, the sooner the less room there is between them, and farthest in the farthest
    // of many places.
    const double contact = state_.mixture.radius[small] + state_.mixture.radius[big];
    const double spacing = tables_.box.length * std::sqrt(1.15 / static_cast<double>(tables_.size));
    const double room = std::fmax(spacing - contact, 0.05 * contact);
    const double farthest = std::log(static_cast<double>(tables_.size));
    freezing_depth_ = std::fmax(farthest * contact * std::fmax(1, way() / room), 2.5 * neighbours.longest_range());
  }
  const std::uint32_t side = grid.side(), depth = grid.rows_within(freezing_depth_);
  const std::uint32_t reach = grid.rows_within(neighbours.longest_range() + way());
  tables_.zones = Array<Tables::Zone>(side);
  for (Tables::Zone& zone : tables_.zones) zone = Tables::Zone::roomy;
  auto mark = [&](std::uint32_t rows_beyond, Tables::Zone zone) {
    for (std::uint32_t s = 0; s < strips_; ++s)
      for (std::uint32_t n = 0; n < std::min(lane_ + 2 * rows_beyond, side); ++n)
        tables_.zones[(border(s) + 2 * side - lane_ / 2 - std::min(rows_beyond, side) + n) % side] = zone;
  };
  mark(depth + reach, Tables::Zone::beside);
  mark(depth, Tables::Zone::near_lane);
}

/// The row amidst the lane below strip s.
std::uint32_t IsaEngine::border(std::uint32_t s) const {
  return static_cast<std::uint32_t>(std::uint64_t{s} * tables_.neighbours.grid.side / strips_);
}

/// Gives the disks to strips, according to what is foreseen for them now.
void IsaEngine::divide() {
  const std::uint32_t side = whole_.neighbours().grid().side(), n = strips_;
  const double range = whole_.neighbours().longest_range();
  auto rows_within = [&](double distance) { return whole_.neighbours().grid().rows_within(distance); };
  reach_ = rows_within(range);
  const std::uint32_t lane = lane_, wide_lane = rows_within(4 * range);
  first_ = std::make_unique<Strip[]>(n);
  shifted_ = std::make_unique<Strip[]>(n);
  lanes_ = std::make_unique<Rows[]>(n);
  auto middle = [&](std::uint32_t s) { return (border(s) + border(s + 1)) / 2; };
  const std::size_t between = tables_.size * 2 * lane / side;  // about as many disks are frozen around a lane
  survey();
  const double window = window_length(), lead = mean_lead();
  tables_.homes = Array<Home>(side);
  for (Home& home : tables_.homes) home = Home::none;
  for (std::uint32_t s = 0; s < n; ++s) {
    const std::uint32_t from = border(s) - lane / 2 + lane, to = border(s + 1) - lane / 2;
    const Home home = s % 2 == 1 ? Home::odd : s + 1 == n && n > 1 ? Home::last : Home::even;
    for (std::uint32_t row = from; row < to; ++row) tables_.homes[row] = home;
    first_[s] = Strip(tables_, {from, to - from, side}, reach_, lane);
    first_[s].set_calendar(calendar_for(lead, tables_.size / n));
    lanes_[s] = {(border(s) + side - lane / 2) % side, lane, side};
    const std::uint32_t below = (s == 0 ? middle(n - 1) : middle(s - 1) + side) - wide_lane / 2 + wide_lane;
    const std::uint32_t above = middle(s) + side - wide_lane / 2;
    shifted_[s] = Strip(tables_, {below % side, above - below, side}, reach_, wide_lane);
    shifted_[s].set_calendar(Calendar(state_.now, window, window / 16, between, tables_.out_of_cache));
  }
  whole_.set_calendar(Calendar(state_.now, window, window / 16, between, tables_.out_of_cache));
  replenish();
  keep();
}

/// Lists hold what can be met while the fastest disk flies window_part_ skins (see make_lists).
double IsaEngine::window_length() const {
  const double fastest = std::fmax(top_speed_[small], top_speed_[big]);
  return std::fmin(way() / fastest, state_.epoch_length);
}

void IsaEngine::do_window(double end) {
  const std::uint32_t n = strips_;
  const double start = state_.now;
  tables_.window = {start, end, {top_speed_[small], top_speed_[big]}, way()};
  whole_.log = strip_log(2 * n);
  for (std::uint32_t s = 0; s < n; ++s) first_[s].log = strip_log(s), shifted_[s].log = strip_log(n + s);

  crew->work(n, [&](unsigned s) {
    first_[s].take_over(shifted_[s]);
    first_[s].take_over(shifted_[(s + 1) % n]);
    first_[s].take_over(whole_);
    first_[s].freeze_rows(lanes_[s]);
  });
  whole_.clear_outbox();
  crew->work(n, [&](unsigned s) { first_[s].first_pass(); });
  if (any_failed()) return undo(start, end);
  crew->work(n, [&](unsigned s) {
    shifted_[s].begin_later_pass();
    shifted_[s].resume(first_[s]);
    shifted_[s].resume(first_[s == 0 ? n - 1 : s - 1]);
    shifted_[s].later_pass();
  });
  if (any_failed()) return undo(start, end);
  std::size_t left = 0, resumed = 0;
  for (std::uint32_t s = 0; s < n; ++s) left += first_[s].left() + shifted_[s].left(), resumed += shifted_[s].resumed();
  if (resumed < left) {
    whole_.begin_later_pass();
    for (std::uint32_t s = 0; s < n; ++s) whole_.resume(first_[s]), whole_.resume(shifted_[s]);
    whole_.later_pass();
    for (std::uint32_t s = 0; s < n; ++s) shifted_[s].sift_outbox();  // it may have changed what these hold
  }
  if (any_failed()) return undo(start, end);
  state_.now = end;
  ++bookkeeping.windows;
  ++windows_done_;
  ++windows_since_kept_;
  bool crossed = whole_.crossed();
  for (std::uint32_t s = 0; s < n; ++s) crossed = shifted_[s].crossed() || crossed;
  if (crossed) find_homes();
  hand_in();
  replenish();
  gather_strip_logs();
}

bool IsaEngine::any_failed() const {
  bool any = whole_.failed();
  for (std::uint32_t s = 0; s < strips_; ++s) any = any || first_[s].failed() || shifted_[s].failed();
  return any;
}

/// How fast disks may be, and how long lists are. A frozen disk is trusted not to be faster than six thermal speeds,
/// beyond which there is one in 10^8, nor than the fastest of all now.
void IsaEngine::survey() {
  struct alignas(64) Part {
    double energy, fastest[species_count];  // fastest: squares
    std::uint32_t longest_list;
  };
  const std::size_t size = tables_.size, threads = strips_;
  Array<Part> parts(threads);
  crew->work(strips_, [&](unsigned s) {
    Part part{0, {0, 0}, 0};
    for (std::size_t i = s * size / threads; i < (s + 1) * size / threads; ++i) {
      const Record& disk = tables_.records[i];
      const double square = disk.vx * disk.vx + disk.vy * disk.vy;
      part.energy += state_.mixture.mass[disk.species] * square / 2;
      part.fastest[disk.species] = std::fmax(part.fastest[disk.species], square);
      part.longest_list = std::max<std::uint32_t>(part.longest_list, disk.neighbour_count);
    }
    parts[s] = part;
  });
  double energy = 0;
  surveyed_balance_ = balance();
  longest_list_ = 0;
  for (const Part& part : parts) energy += part.energy, longest_list_ = std::max(longest_list_, part.longest_list);
  surveyed_energy_ = energy;
  for (const int species : {small, big}) {
    double fastest = 0;
    for (const Part& part : parts) fastest = std::fmax(fastest, part.fastest[species]);
    const double thermal = std::sqrt(energy / static_cast<double>(size) / state_.mixture.mass[species]);
    top_speed_[species] = caution_ * (tuning_.top_speed > 0 ? tuning_.top_speed * thermal
                                                            : std::fmax(6.25 * thermal, 1.1 * std::sqrt(fastest)));
  }
  if (state_.mixture.radius[small] == state_.mixture.radius[big])  // by which species are told apart
    top_speed_[small] = top_speed_[big] = std::fmax(top_speed_[small], top_speed_[big]);
}

/// Energy gained less energy lost, up to now.
double IsaEngine::balance() const { return state_.tally.injected.value() - state_.tally.dissipated.value(); }

/// Since the survey, and by more than fluctuates: in a fluid that cools disks would be trusted to be far too fast.
bool IsaEngine::temperature_has_changed() const {
  const double energy = surveyed_energy_ + balance() - surveyed_balance_;
  return energy < 0.7 * surveyed_energy_ || energy > 1.4 * surveyed_energy_;
}

/// Keeps the disks as they are, for undo. Lists get more room before one is full: in a window they may not move. The
/// calendars are made anew as well: whenever a disk is resumed its next kick is entered again, and rare kicks would
/// pile up.
void IsaEngine::keep() {
  find_homes();
  survey();
  const std::size_t size = tables_.size, threads = strips_;
  if (kept_.size() != size) kept_ = Array<KeptDisk>(size);
  crew->work(strips_, [&](unsigned s) {
    for (std::size_t i = s * size / threads; i < (s + 1) * size / threads; ++i) {
      const ColdRecord& cold = tables_.cold[i];
      kept_[i] = {tables_.records[i], cold.last_contact, cold.next_kick, cold.kick_count, tables_.images[i]};
    }
  });
  whole_.neighbours().make_room(longest_list_ + std::max(2u, longest_list_ / 5));
  kept_tally_ = state_.tally;
  kept_now_ = state_.now;
  windows_since_kept_ = 0;
}

/// Every disk gets the strip where it stands for its home. The calendars are made anew: no entry may outlive its disk's
/// stay in a strip (and the lanes beside it).
void IsaEngine::find_homes() {
  const std::size_t size = tables_.size, threads = strips_;
  crew->work(strips_, [&](unsigned s) {
    for (std::size_t i = s * size / threads; i < (s + 1) * size / threads; ++i)
      tables_.records[i].home = tables_.homes[first_[0].neighbours().grid().row_of(tables_.cold[i].centre)];
    first_[s].remake_calendar();
    shifted_[s].clear_outbox();
  });
  whole_.clear_outbox();
}

/// Goes back to the disks that were kept and does all up to `end` again on one thread; up to `start` it has been
/// logged.
void IsaEngine::undo(double start, double end) {
  ++bookkeeping.windows_undone;
  bool too_fast = whole_.too_fast(), too_deep = false;
  for (std::uint32_t s = 0; s < strips_; ++s) {
    too_fast = too_fast || first_[s].too_fast() || shifted_[s].too_fast();
    too_deep = too_deep || first_[s].too_deep() || shifted_[s].too_deep();
  }
  if (too_fast) caution_ *= 1.1;
  if (too_deep) freezing_depth_ *= 1.5;
  hand_in();
  drop_strip_logs();
  for (std::size_t i = 0; i < tables_.size; ++i) {
    const KeptDisk& kept = kept_[i];
    ColdRecord& cold = tables_.cold[i];
    tables_.records[i] = kept.record;
    tables_.images[i] = kept.image;
    cold.last_contact = kept.last_contact, cold.next_kick = kept.next_kick;
    cold.kick_count = kept.kick_count;
  }
  state_.tally = kept_tally_;
  state_.now = kept_now_;
  make_lists();
  make_calendar();
  whole_.log = nullptr;
  whole_.run(start);
  whole_.log = log;
  whole_.run(end);
  state_.now = end;
  hand_in();
  if (++undone_ > 3 && 8 * undone_ > windows_done_) strips_ = 1;  // it does not pay here
  if (strips_ > 1) divide();
}

/// Adds what the strips have counted.
void IsaEngine::hand_in() {
  whole_.hand_in(state_.tally, bookkeeping);
  for (std::uint32_t s = 0; strips_ > 1 && s < strips_; ++s) {
    first_[s].hand_in(state_.tally, bookkeeping);
    shifted_[s].hand_in(state_.tally, bookkeeping);
  }
}

/// Sees to it that every strip has room for the cells that will be overfull: without, it would have to freeze disks.
void IsaEngine::replenish() {
  const auto room = static_cast<std::uint32_t>(64 + tables_.size / strips_ / 256);
  auto see_to = [room](Neighbours& neighbours) {
    if (neighbours.grid().spare_lines() < room) neighbours.grid().take_lines(4 * room);
  };
  for (std::uint32_t s = 0; s < strips_; ++s) see_to(first_[s].neighbours()), see_to(shifted_[s].neighbours());
}

}  // namespace SANDGLASS_ISA

#define SANDGLASS_JOIN_(a, b) a##b
#define SANDGLASS_JOIN(a, b) SANDGLASS_JOIN_(a, b)
Engine* SANDGLASS_JOIN(make_engine_, SANDGLASS_ISA)(State& state, const Tuning& tuning) {
  return new IsaEngine(state, tuning);
}

}  // namespace sandglass
