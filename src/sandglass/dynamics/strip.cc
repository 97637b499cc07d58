// The hot loop. Invariants, at every moment between two events:
//  1. A record is as its disk's own last contact, kick, transit or epoch left it. Nothing else writes to its flight.
//  2. A foreseen contact is mutual: both disks name each other, with the same time.
//  3. No disk's next event comes later, in canonical order, than its own kick, its transit or the expiry of its list;
//     and no contact of a listed pair, as computed from the records as they are now, comes before the next events of
//     both its disks. So the earliest next event of all, unless it is a review, is the earliest event there is.
//  4. Every finite next event has an entry in the calendar, a contact one for the pair, a kick that which it was given
//     when its clock was set; until the window of a kick opens it has that also while it is not the next event.
//  5. Two disks that overlap or touch are in each other's lists; lists are symmetric.
#include "sandglass/dynamics/strip.h"

#include <cassert>

#include "sandglass/dynamics/epoch.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

Strip::Strip(Tables& tables)
    : tables_(&tables),
      records_(tables.records.begin()),
      cold_(tables.cold.begin()),
      ids_(tables.ids.begin()),
      images_(tables.images.begin()),
      box_(tables.box),
      law_(tables.state.collision),
      leash_{tables.leash[false], tables.leash[true]},
      neighbours_(tables.neighbours) {
  for (const int a : {small, big})
    for (const int b : {small, big}) masses_[a][b] = tables.masses[a][b];
  set_next(batch_.nobody, never, Next::review, no_disk);
  for (std::uint32_t& partner : likely_partners_) partner = no_disk;
  if (tables.size == 0) return;
  const double range = neighbours_.longest_range() / neighbours_.grid().unit() + 2;
  range_ = range < 0xffffffffu ? static_cast<std::uint32_t>(range) : 0xffffffffu;
}

Strip::Strip(Tables& tables, Rows core, std::uint32_t reach, std::uint32_t lane) : Strip(tables) {
  core_ = core;
  reach_ = reach;
  lane_ = lane;
  whole_ = false;
}

void Strip::run(double end) {
  end_ = end;
  auto in_order = [this](std::uint32_t a, std::uint32_t b) { return before(a, b); };
  const bool in_batches = tables_->in_batches && whole_;  // a batch also reads records that it does not need
  for (;;) {
    if (in_batches && run_batch()) continue;
    const std::uint32_t i = calendar_.pop(records_, end_, in_order);
    if (i == no_disk) return;
    fetch_ahead();
    assert(owns(i));
    const Record& disk = records_[i];
    const double t = disk.next_time;
    if (--until_stall_check_ == 0) [[unlikely]]
      check_progress(t);
    switch (disk.next) {
      case Next::contact:
      case Next::contact_entered_by_partner:
        on_contact(i, disk.partner, t);
        break;
      case Next::kick:
        on_kick(i, t);
        break;
      case Next::transit:
        on_transit(i, t);
        break;
      case Next::review:
        on_review(i, t);
        break;
      case Next::freeze:
        fetch_listed_ahead();
        freeze(i, t);
        fetch_others_ahead();
        break;
    }
  }
}

void Strip::hand_in(Tally& tally, Simulation::Bookkeeping& bookkeeping) {
  for (int pair = 0; pair < 3; ++pair) tally.contacts[pair] += tally_.contacts[pair];
  for (const int species : {small, big}) tally.kicked[species] += tally_.kicked[species];
  tally.elastic_contacts += tally_.elastic_contacts;
  tally.kicks += tally_.kicks;
  tally.kicks_without_partner += tally_.kicks_without_partner;
  tally.transits += tally_.transits;
  tally.virial.add(tally_.virial);
  tally.dissipated.add(tally_.dissipated);
  tally.injected.add(tally_.injected);
  tally_ = Tally();
  bookkeeping.predictions += bookkeeping_.predictions;
  bookkeeping.orphans += bookkeeping_.orphans;
  bookkeeping.list_rebuilds += bookkeeping_.list_rebuilds;
  bookkeeping.wide_partner_searches += bookkeeping_.wide_partner_searches;
  bookkeeping.frozen += bookkeeping_.frozen;
  bookkeeping.left_over += bookkeeping_.left_over;
  bookkeeping_ = {};
}

/// Brings what the events after the present one will need nearer to the processor. Each stage reads what the one before
/// has fetched. The neighbours, by far the most of it, are left for two portions amidst the present event: all at once
/// they would queue for the memory.
[[gnu::always_inline]] inline void Strip::fetch_ahead() {
  if (!tables_->out_of_cache) return fetch_within_cache(0);
  auto coming = [this](std::size_t events) {
    const Calendar::Coming entry = calendar_.coming(events);
    return entry.time < never ? entry.slot : no_disk;
  };
  if (const std::uint32_t i = coming(12); i != no_disk) {
    fetch_disks(i);
    prefetch(&records_[partner_or_self(i)]);  // says how long the partner's list is
  }
  upcoming_ = coming(8);
  if (const std::uint32_t i = coming(5); i != no_disk) fetch_kick_partner(i);
  if (const std::uint32_t i = coming(2); i != no_disk) fetch_partners_neighbours(i);
}

/// The first portion.
[[gnu::always_inline]] inline void Strip::fetch_listed_ahead() const {
  if (upcoming_ != no_disk) fetch_listed(upcoming_);
}

/// The second portion.
[[gnu::always_inline]] inline void Strip::fetch_others_ahead() const {
  if (upcoming_ != no_disk) fetch_others(upcoming_);
}

/// From one level of the cache to the next, for the events after the n-th from now.
[[gnu::always_inline]] inline void Strip::fetch_within_cache(std::size_t n) const {
  prefetch(&records_[calendar_.coming(n + 8).slot]);
  if (const Calendar::Coming later = calendar_.coming(n + 4); later.time < never) fetch_disks(later.slot);
}

/// Its cold record with the list, and its partner's.
void Strip::fetch_disks(std::uint32_t i) const {
  fetch_disk(i);
  fetch_disk(partner_or_self(i));
}

void Strip::fetch_disk(std::uint32_t i) const { prefetch(&cold_[i]); }

/// Through its list, its neighbours.
void Strip::fetch_listed(std::uint32_t i) const {
  const std::uint32_t* list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < Neighbours::block; ++n) prefetch(&records_[list[n]]);
  prefetch(records_[i].neighbour_count > Neighbours::block ? neighbours_.more(i) : list);
}

/// The neighbours of its partner; where its list expires the grid.
void Strip::fetch_others(std::uint32_t i) const {
  const Record& disk = records_[i];
  if (disk.partner != no_disk)
    fetch_listed(disk.partner);
  else if (disk.next == Next::review && !within_leash(disk, cold_[i], disk.next_time))
    fetch_grid(disk);
}

/// The grid around where the disk will be at its next event.
void Strip::fetch_grid(const Record& disk) const {
  const auto [x, y] = position_at(disk, disk.next_time);
  neighbours_.fetch(neighbours_.grid().point(x, y), disk);
}

/// The partner of its kick will most likely be the one that would be if nothing happened until then.
void Strip::fetch_kick_partner(std::uint32_t i) {
  const Record& disk = records_[i];
  const Drive& drive = tables_->state.drive;
  std::uint32_t& likely_partner = likely_partners_[i % 16];
  likely_partner = no_disk;
  if (disk.next != Next::kick || drive.kind != DriveKind::pair) return;
  if (drive.partner == PartnerRule::within) return fetch_grid(disk);
  const auto [partner, gap] = nearest_listed(i, disk.next_time);
  likely_partner = partner;
  if (partner != no_disk) fetch_disk(partner);
  if (!nobody_unlisted_within(gap, i, disk.next_time)) fetch_grid(disk);
}

void Strip::fetch_partners_neighbours(std::uint32_t i) const {
  if (records_[i].next == Next::kick && likely_partners_[i % 16] != no_disk) fetch_listed(likely_partners_[i % 16]);
}

/// In an inelastic collapse infinitely many collisions take place in a finite time, and the loop would never end. After
/// 64 events per disk (and a million at least) time must have gone on by more than a billionth of a mean free time.
void Strip::check_progress(double t) {
  if (t - progress_time_ < 1e-9 * tables_->state.epoch_length / beats_per_epoch) report_collapse(tables_->state, t);
  progress_time_ = t;
  until_stall_check_ = (std::uint64_t{1} << 20) + 64 * tables_->size;
}

/// The collision of two disks at time t, worked out but, their images apart, not carried out.
[[gnu::always_inline]] inline Strip::Collision Strip::collision(std::uint32_t i, std::uint32_t j, double t) {
  const ColdRecord &cold_a = cold_[i], &cold_b = cold_[j];
  Collision result{i,
                   j,
                   Flight(records_[i]),
                   Flight(records_[j]),
                   {},
                   elastic_by_tc(law_, t, cold_a.last_contact, cold_b.last_contact)};
  advance(result.a, images_[i].x, images_[i].y, t, box_);
  advance(result.b, images_[j].x, images_[j].y, t, box_);
  const PairMasses& masses = masses_[records_[i].species][records_[j].species];
  result.impact = collide(result.a, result.b, masses, result.elastic ? 1.0 : law_.restitution, box_);
  return result;
}

[[gnu::always_inline]] inline void Strip::carry_out(const Collision& result) {
  const auto [i, j, a, b, impact, elastic] = result;
  ColdRecord &cold_a = cold_[i], &cold_b = cold_[j];
  set_flight(records_[i], a);
  set_flight(records_[j], b);
  cold_a.last_contact = cold_b.last_contact = a.time;

  ++tally_.contacts[records_[i].species + records_[j].species];
  tally_.elastic_contacts += elastic;
  tally_.virial.add(impact.virial);
  tally_.dissipated.add(impact.dissipated);
  if (log) [[unlikely]]
    ids_[i] < ids_[j] ? log_event(EventKind::contact, a.time, i, j) : log_event(EventKind::contact, a.time, j, i);
}

/// The searches for what comes next begin before the new flights are written: they need not wait for that, nor for each
/// other. The two disks themselves are left out; they have just parted.
void Strip::on_contact(std::uint32_t i, std::uint32_t j, double t) {
  const Collision result = collision(i, j, t);
  fetch_listed_ahead();
  const Lanes of_i = first_contacts(i, result.a, j), of_j = first_contacts(j, result.b, i);
  carry_out(result);
  settle(i, of_i);
  fetch_others_ahead();
  settle(j, of_j);
}

void Strip::on_kick(std::uint32_t i, double t) {
  fetch_listed_ahead();
  ColdRecord& cold = cold_[i];
  const Kick kick = next_kick(i, t);
  const Drive& drive = tables_->state.drive;
  const bool pair = drive.kind == DriveKind::pair;
  std::uint32_t j = no_disk;
  if (pair) {
    j = drive.partner == PartnerRule::within ? partner_within_reach(i, t, kick) : nearest_partner(i, t);
    if (j == undecided) return freeze(i, t);
  }
  ++cold.kick_count;
  cold.next_kick = t + kick.wait / clock_rate(drive);
  enter_next_kick(i);
  if (log) [[unlikely]]
    log_event(EventKind::kick, t, i, j);
  if (pair && j == no_disk) {
    ++tally_.kicks_without_partner;
    set_next(records_[i], never, Next::review, no_disk);
    return predict(i);
  }
  ++tally_.kicks;
  const double px = drive.amplitude * kick.px, py = drive.amplitude * kick.py;
  tally_.injected.add(pair ? kick_pair(i, j, t, px, py) : kick_alone(i, t, px, py));
}

/// The next kick of disk i, which comes at time t. Most often it has been drawn already.
Kick Strip::next_kick(std::uint32_t i, double t) {
  const std::uint64_t count = cold_[i].kick_count + 1;
  if (t > drawn_until_) draw_kicks(i, t);
  const unsigned lanes = equal_lanes(drawn_kicks_.slot, i);
  const auto n = static_cast<unsigned>(__builtin_ctz(lanes | 1u << 31)) % DrawnKicks::size;
  if (lanes != 0 && drawn_kicks_.count[n] == count) [[likely]]
    return drawn_kicks_.kick(n);
  return Kick::draw(tables_->state.seed, ids_[i], count);
}

/// Draws the kick of disk i, which comes at time t, and those that the calendar has next. These come as a surprise to
/// the processor: what the search for their partners reads is brought nearer meanwhile.
void Strip::draw_kicks(std::uint32_t i, double t) {
  DrawnKicks& drawn = drawn_kicks_;
  std::uint32_t size = 0;
  auto add = [&](std::uint32_t slot, double time) {
    drawn.slot[size] = slot, drawn.id[size] = ids_[slot], drawn.count[size] = cold_[slot].kick_count + 1;
    ++size;
    drawn_until_ = time;
    fetch_disk(slot);
  };
  add(i, t);
  for (std::size_t n = 0; n < 32 && size < DrawnKicks::size; ++n) {
    const Calendar::Coming entry = calendar_.coming(n);
    if (entry.time == never) break;
    const Record& disk = records_[entry.slot];
    if (disk.next == Next::kick && disk.next_time == entry.time && entry.slot != i) add(entry.slot, entry.time);
  }
  drawn.draw(tables_->state.seed);
  for (std::uint32_t n = 0; n < size; ++n)
    for (std::uint32_t m = 0; m < Neighbours::block; ++m) prefetch(&records_[neighbours_.list(drawn.slot[n])[m]]);
}

/// The clock of disk i has been set: its kick has an entry from now on, whatever else comes before. In a later pass it
/// needs one for the strip where the disk stands, if it comes after the window.
void Strip::enter_next_kick(std::uint32_t i) {
  const double t = cold_[i].next_kick;
  if (t < never && (first_pass_ || t > outbox_from_)) enter_event(t, i);
}

/// The kick of disk i comes next.
void Strip::enter_kick_again(std::uint32_t i) {
  const double t = cold_[i].next_kick;
  if (first_pass_)
    calendar_.push_again(t, i);
  else if (t <= outbox_from_)
    enter_event(t, i);
}

/// Gives momentum to disk i at time t; returns the energy gained.
double Strip::kick_alone(std::uint32_t i, double t, double px, double py) {
  Flight flight(records_[i]);
  advance(flight, images_[i].x, images_[i].y, t, box_);
  const double gained = give_momentum(flight, px, py, inverse_mass(records_[i]));
  set_flight(records_[i], flight);
  ++tally_.kicked[records_[i].species];
  fetch_others_ahead();
  predict(i);
  return gained;
}

/// Gives momentum to disk i, and the opposite to disk j; returns the energy gained. As in on_contact, the searches
/// begin before the new flights are written.
double Strip::kick_pair(std::uint32_t i, std::uint32_t j, double t, double px, double py) {
  Record &disk_i = records_[i], &disk_j = records_[j];
  Flight a(disk_i), b(disk_j);
  advance(a, images_[i].x, images_[i].y, t, box_);
  advance(b, images_[j].x, images_[j].y, t, box_);
  const double gained =
      give_momentum(a, px, py, inverse_mass(disk_i)) + give_momentum(b, -px, -py, inverse_mass(disk_j));
  const Lanes of_i = first_contacts(i, a, j, b), of_j = first_contacts(j, b, i, a);
  if (disk_j.partner != no_disk) leave_partner(disk_j);  // i has none, or its kick would not have come next
  set_flight(disk_i, a);
  set_flight(disk_j, b);
  ++tally_.kicked[disk_i.species];
  ++tally_.kicked[disk_j.species];
  settle(i, of_i);
  fetch_others_ahead();
  settle(j, of_j);
  return gained;
}

void Strip::on_transit(std::uint32_t i, double t) {
  fetch_listed_ahead();
  Flight flight(records_[i]);
  advance(flight, images_[i].x, images_[i].y, t, box_);
  set_flight(records_[i], flight);
  ++tally_.transits;
  fetch_others_ahead();
  if (log) log_event(EventKind::transit, t, i, no_disk);
  predict(i);
}

/// Looks again for the next contact of disk i, after making its list anew if that has expired.
void Strip::on_review(std::uint32_t i, double t) {
  fetch_listed_ahead();
  set_next(records_[i], never, Next::review, no_disk);
  const bool still_listed = within_leash(records_[i], cold_[i], t);
  if (!still_listed && !remake_list(i, t)) [[unlikely]]
    return freeze(i, t);
  fetch_others_ahead();
  predict(i);
  if (still_listed) return;
  tell_listed(i);
}

/// Enters disk i, whose list has been made anew, into those of the others.
void Strip::tell_listed(std::uint32_t i) {
  if (!neighbours_.tell_others(i, records_, !whole_)) [[unlikely]]
    give_up();
}

/// The window must be undone: stops the loop.
void Strip::give_up() {
  failed_ = true;
  end_ = tables_->window.start;
}

/// Makes the list of disk i anew around where it is at time t; tell_listed must follow. Its record does not
/// change. Nobody names i, whose next event this was; so nobody who has left its list does. False if that would reach
/// into what another thread works on.
bool Strip::remake_list(std::uint32_t i, double t) {
  Flight now(records_[i]);
  std::int32_t image_x = 0, image_y = 0;
  advance(now, image_x, image_y, t, box_);
  const FixedPoint centre = neighbours_.grid().point(now.x, now.y);
  const std::uint32_t before = row(i), after = neighbours_.grid().row_of(centre);
  if (!whole_ && !(may_change_lists_at(before) && may_change_lists_at(after))) return false;
  if (!neighbours_.renew(i, cold_[i].centre, centre, records_, !whole_)) return false;
  ++bookkeeping_.list_rebuilds;
  set_centre(i, centre);
  if (!records_[i].roomy && !whole_ && menace(i).any) concern(i);  // where it is roomy no frozen one is in reach
  if (!first_pass_) find_home(i);
  return true;
}

/// Canonical order of two disks' next events at one time: kind, then ids.
bool Strip::before(std::uint32_t a, std::uint32_t b) const {
  const Record &disk_a = records_[a], &disk_b = records_[b];
  auto kind = [](Next next) { return next == Next::contact_entered_by_partner ? Next::contact : next; };
  if (kind(disk_a.next) != kind(disk_b.next)) return disk_a.next < disk_b.next;
  auto ids = [&](std::uint32_t slot, const Record& disk) {
    const std::uint64_t own = ids_[slot];
    const std::uint64_t other = disk.partner == no_disk ? no_disk : ids_[disk.partner];
    return own < other ? own << 32 | other : other << 32 | own;
  };
  return ids(a, disk_a) < ids(b, disk_b);
}

void Strip::log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const {
  append_event(*log, {t, kind, ids_[i], j == no_disk ? no_disk : ids_[j]});
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
