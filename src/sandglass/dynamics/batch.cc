// Some of the next events, worked out together. One event after the other, the processor waits most of the time: each
// number needs the one before, and half a dozen branches cannot be foretold. So up to eight events whose disks are not
// in each other's lists are gathered, and each step is taken for all of them: their collisions, the searches for what
// comes next, and at last, in order of time, what is written. An event that turns out to come after something else is
// forgotten, and its turn comes again; nothing of it has been written.
//
// Why this is the same as one by one (the rules are in strip.cc). Of two events of a batch, the first changes flights
// of its own disks alone, which the searches of the second do not read. It may bring a third disk to choose another
// partner than the second has found: that is seen when the second is written, by the third's next_time, which only ever
// becomes earlier, and the second looks again. And it may bring about an event that comes before the second: then the
// batch ends.
#include <algorithm>
#include <bit>
#include <cassert>

#include "sandglass/dynamics/contact_vector.h"
#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

#ifdef SANDGLASS_SIMD

#define SANDGLASS_INLINE __attribute__((always_inline))

/// Does some of the next events. False if the next one must be done by itself.
bool Strip::run_batch() {
  Batch& batch = batch_;
  gather();
  if (batch.count > 0) {
    fly();
    batch.count = std::min(batch.count, collide_all());
  }
  if (batch.count == 0) {
    if (batch.late) calendar_.put_back(batch.time[0], batch.slot[0]);
    return false;
  }
  search_listed();
  search_far();
  foresee_all_else();
  carry_out_batch();
  return true;
}

/// Takes contacts and reviews from those that come next, up to the first that is something else, or one of whose
/// disks is in the list of one before. Lists that expire are made anew at once: that leaves no trace.
[[gnu::always_inline]] inline void Strip::gather() {
  Batch& batch = batch_;
  unsigned picked = 0;
  batch.late = false;
  batch.count = 0;
  double late = calendar_.late_soonest();
  if (late < calendar_.coming(0).time && late <= end_) {
    const std::uint32_t i = calendar_.take_late();
    if (i == no_disk) return;
    batch.slot[0] = i;
    batch.time[0] = late;
    batch.entries[0] = 0;
    picked = records_[i].next_time == late;
    batch.late = picked > 0;
    late = calendar_.late_soonest();
  }
  for (unsigned n = 0; n < Batch::size + Batch::size / 2 && picked < Batch::size; ++n) {
    const Calendar::Coming entry = calendar_.coming(n);
    if (entry.time > end_ || entry.time >= late || entry.time == calendar_.coming(n + 1).time) [[unlikely]]
      break;
    batch.slot[picked] = entry.slot;
    batch.time[picked] = entry.time;
    batch.entries[picked] = n + 1;
    picked += records_[entry.slot].next_time == entry.time;
  }

  unsigned m = 0, special = 0;
  while (m < picked && describe(m, special)) ++m;
  batch.special = special;

  unsigned stop = 1u << m;  // the first event that is beside one before
  for (unsigned k = 1; k < Batch::size; ++k) {
    const std::uint64_t a = batch.centre[k], b = batch.centre[k + Batch::size];
    const std::uint64_t *const firsts = batch.centre, *const seconds = batch.centre + Batch::size;
    const unsigned near = lanes_within(firsts, a, range_) | lanes_within(firsts, b, range_) |
                          lanes_within(seconds, a, range_) | lanes_within(seconds, b, range_);
    stop |= static_cast<unsigned>((near & ((1u << 2 * k) - 1)) != 0) << k;
  }
  batch.count = static_cast<unsigned>(__builtin_ctz(stop));
  if (batch.count == 1 && !batch.late) batch.count = 0;  // one by itself is done faster without
}

/// All that is needed to work out event m. False if it is none for a batch.
[[gnu::always_inline]] inline bool Strip::describe(unsigned m, unsigned& special) {
  Batch& batch = batch_;
  const std::uint32_t i = batch.slot[m];
  const Record& disk = records_[i];
  const double t = batch.time[m];
  const bool contact = disk.partner != no_disk;
  if (!contact) {
    if (disk.next != Next::review) return false;
    if (!within_leash(disk, cold_[i], t)) {
      // The list must hold from the first event on.
      const double flight = t - batch.time[0], leash = leash_[0];
      if ((disk.vx * disk.vx + disk.vy * disk.vy) * (flight * flight) > 0.99 * leash * leash || !remake_list(i, t))
        return false;
      tell_listed(i);
    }
  }
  const std::uint32_t j = contact ? disk.partner : i;
  const ColdRecord &cold_a = cold_[i], &cold_b = cold_[j];
  auto fill = [&](unsigned lane, const Record& record, const ColdRecord& cold) SANDGLASS_INLINE {
    batch.centre[lane] = std::bit_cast<std::uint64_t>(cold.centre);
    batch.leash_squared[lane] = leash_[record.roomy] * leash_[record.roomy];
    special |= static_cast<unsigned>(record.concerned | (cold.next_kick < never)) << lane;
    batch.flown_to[lane] = contact ? t : disk.time;
  };
  fill(m, disk, cold_a);
  fill(m + Batch::size, records_[j], cold_b);
  batch.slot[m + Batch::size] = j;
  batch.contact[m] = contact;
  batch.contact_if_1[m] = contact;
  const PairMasses& masses = masses_[disk.species][records_[j].species];
  batch.reduced[m] = masses.reduced, batch.reduced_low[m] = masses.reduced_low;
  batch.inverse_a[m] = masses.inverse_a, batch.inverse_b[m] = masses.inverse_b;
  batch.elastic[m] = elastic_by_tc(law_, t, cold_a.last_contact, cold_b.last_contact);
  batch.restitution[m] = batch.elastic[m] ? 1.0 : law_.restitution;
  return true;
}

/// `advance` for all disks.
[[gnu::always_inline]] inline void Strip::fly() {
  Batch& batch = batch_;
  const Vector zero = Vector::all(0), one = Vector::all(1), length = Vector::all(box_.length);
  unsigned wrapped = 0;
  for (unsigned lane = 0; lane < Batch::lanes; lane += Vector::width) {
    Vector disk[8];
    load_columns(records_, batch.slot + lane, disk);
    const Vector flight = Vector::load(batch.flown_to + lane) - disk[4];
    auto wrap = [&](Vector position, double* to, double* image) SANDGLASS_INLINE {
      const Mask below = position < zero;
      position = choose(below, position + length, position);
      const Mask above = length <= position;
      choose(above, position - length, position).store(to);
      (choose(above, one, zero) - choose(below, one, zero)).store(image);
      wrapped |= (below | above).lanes() << lane;
    };
    wrap(fma(disk[2], flight, disk[0]), batch.x + lane, batch.image_x + lane);
    wrap(fma(disk[3], flight, disk[1]), batch.y + lane, batch.image_y + lane);
    disk[2].store(batch.vx + lane);
    disk[3].store(batch.vy + lane);
  }
  batch.wrapped = wrapped;
}

/// `collide` for all events; how many there are up to the first grazing contact, which must be done by itself.
[[gnu::always_inline]] inline unsigned Strip::collide_all() {
  Batch& batch = batch_;
  const Vector zero = Vector::all(0), one = Vector::all(1);
  unsigned grazing = 1u << Batch::size;
  for (unsigned a = 0; a < Batch::size; a += Vector::width) {
    const unsigned b = a + Batch::size;
    const Vector rx = nearest(Vector::load(batch.x + b) - Vector::load(batch.x + a), box_);
    const Vector ry = nearest(Vector::load(batch.y + b) - Vector::load(batch.y + a), box_);
    const Vector rr = fma(rx, rx, ry * ry);
    const Vector avx = Vector::load(batch.vx + a), avy = Vector::load(batch.vy + a);
    const Vector bvx = Vector::load(batch.vx + b), bvy = Vector::load(batch.vy + b);
    auto approach = [&](Vector ax, Vector ay, Vector bx, Vector by) { return fma(rx, bx - ax, ry * (by - ay)); };
    const Vector rv = approach(avx, avy, bvx, bvy), restitution = Vector::load(batch.restitution + a);
    const Vector reduced = Vector::load(batch.reduced + a), reduced_low = Vector::load(batch.reduced_low + a);
    const Vector virial = (zero - (one + restitution)) * fma(reduced, rv, reduced_low * rv), impulse = virial / rr;
    const Vector px = impulse * rx, py = impulse * ry;
    const Vector inverse_a = Vector::load(batch.inverse_a + a), inverse_b = Vector::load(batch.inverse_b + a);
    const Vector ax = avx - px * inverse_a, ay = avy - py * inverse_a;
    const Vector bx = bvx + px * inverse_b, by = bvy + py * inverse_b;
    const Mask contact = zero < Vector::load(batch.contact_if_1 + a);
    grazing |= (contact & (approach(ax, ay, bx, by) < zero)).lanes() << a;
    choose(contact, ax, avx).store(batch.vx + a), choose(contact, ay, avy).store(batch.vy + a);
    bx.store(batch.vx + b), by.store(batch.vy + b);
    choose(contact, virial, zero).store(batch.virial + a);
    choose(contact, Vector::all(-0.5) * virial * (one - restitution) * rv / rr, zero).store(batch.dissipated + a);
  }
  return static_cast<unsigned>(__builtin_ctz(grazing));
}

/// The earliest contact of every disk with the first of its list; the two disks of an event left out. Roots and
/// divisions take long: meanwhile the next search begins.
[[gnu::always_inline]] inline void Strip::search_listed() {
  Batch& batch = batch_;
  unsigned searches = 0;
  for (unsigned m = 0; m < Batch::size; ++m) {
    const unsigned counts = m < batch.count, two = batch.contact[m];
    batch.lane[searches] = m;
    searches += counts;
    batch.lane[searches] = m + Batch::size;
    searches += counts & two;
  }
  batch.searches = searches;

  constexpr unsigned behind = 2;
  const unsigned begun = searches < behind ? searches : behind;
  for (unsigned n = 0; n < begun; ++n) approach_listed(n);
  for (unsigned n = begun; n < searches; ++n) {
    if (n % 2 == 0) fetch_within_cache(n / 2 + 11);
    if (n + 2 < searches) fetch_listed(batch.slot[batch.lane[n + 2]]);
    approach_listed(n);
    meet_listed(n - behind);
  }
  for (unsigned n = searches - begun; n < searches; ++n) meet_listed(n);

  alignas(64) double soonest[Batch::lanes];
  smallest_of_rows(batch.when[0], soonest);
  if (searches > Batch::size) smallest_of_rows(batch.when[Batch::size], soonest + Batch::size);
  unsigned doubtful = 0;
  for (unsigned n = 0; n < searches; ++n) {
    const unsigned lane = batch.lane[n], lanes = equal_lanes(batch.when[n], soonest[n]);
    const unsigned some = soonest[n] < never, several = (lanes & (lanes - 1)) != 0;
    batch.soonest[lane] = soonest[n];
    batch.partner[lane] = neighbours_.list(batch.slot[lane])[static_cast<unsigned>(__builtin_ctz(lanes))];
    doubtful |= (some & (several | batch.tied[n])) << lane;
  }
  batch.doubtful = doubtful;
}

/// Search n as far as the root.
[[gnu::always_inline]] inline void Strip::approach_listed(unsigned n) {
  Batch& batch = batch_;
  const unsigned lane = batch.lane[n];
  const std::uint32_t i = batch.slot[lane], other = batch.slot[lane ^ Batch::size];
  const FlightColumns disk{Vector::all(batch.x[lane]),        Vector::all(batch.y[lane]),
                           Vector::all(batch.vx[lane]),       Vector::all(batch.vy[lane]),
                           Vector::all(batch.flown_to[lane]), Vector::all(records_[i].radius)};
  for (unsigned first = 0; first < Batch::listed; first += Vector::width) {
    const std::uint32_t* const list = neighbours_.list(i) + first;
    Vector columns[8];
    load_columns(records_, list, columns);
    const Approach approach(disk, columns, box_);
    approach.ru.store(batch.ru[n] + first);
    approach.c.store(batch.c[n] + first);
    approach.discriminant.store(batch.discriminant[n] + first);
    approach.from.store(batch.from[n] + first);
    choose(other_than(list, other) & approach.meets(), columns[5], Vector::all(nobodys)).store(batch.limit[n] + first);
  }
}

/// The rest of search n: when the contacts are, if not after what the other has next.
[[gnu::always_inline]] inline void Strip::meet_listed(unsigned n) {
  Batch& batch = batch_;
  unsigned tied = 0;
  for (unsigned first = 0; first < Batch::listed; first += Vector::width) {
    const Approach approach{Vector::load(batch.from[n] + first), Vector::load(batch.ru[n] + first),
                            Vector::load(batch.c[n] + first), Vector::load(batch.discriminant[n] + first)};
    const Vector when = approach.contact_time(), limit = Vector::load(batch.limit[n] + first);
    choose(when <= limit, when, Vector::all(never)).store(batch.when[n] + first);
    tied |= (when == limit).lanes();
  }
  batch.tied[n] = tied != 0;
}

/// The rest of the lists, all in common vectors.
[[gnu::always_inline]] inline void Strip::search_far() {
  Batch& batch = batch_;
  unsigned far = 0, doubtful = batch.doubtful;
  for (unsigned n = 0; n < batch.searches; ++n) {
    const unsigned lane = batch.lane[n];
    const std::uint32_t i = batch.slot[lane], other = batch.slot[lane ^ Batch::size];
    const Record& disk = records_[i];
    const std::uint32_t* const list = neighbours_.more(i);
    unsigned last = disk.neighbour_count;
    if (last > 2 * Batch::listed) [[unlikely]] {
      doubtful |= 1u << lane;
      last = 2 * Batch::listed;
    }
    for (unsigned k = 0; k + Batch::listed < last; ++k, ++far) {
      batch.far_slot[far] = list[k] != other ? list[k] : nobody();
      batch.far_lane[far] = lane;
      batch.far_x[far] = batch.x[lane], batch.far_y[far] = batch.y[lane];
      batch.far_vx[far] = batch.vx[lane], batch.far_vy[far] = batch.vy[lane];
      batch.far_time[far] = batch.flown_to[lane], batch.far_radius[far] = disk.radius;
    }
  }
  for (unsigned first = 0; first < far; first += Vector::width) {
    for (unsigned k = far; k < first + Vector::width; ++k) batch.far_slot[k] = nobody();
    const FlightColumns disks{Vector::load(batch.far_x + first),    Vector::load(batch.far_y + first),
                              Vector::load(batch.far_vx + first),   Vector::load(batch.far_vy + first),
                              Vector::load(batch.far_time + first), Vector::load(batch.far_radius + first)};
    Vector columns[8];
    load_columns(records_, batch.far_slot + first, columns);
    const Vector candidate = contact_times(disks, columns, everywhere(), box_);
    const unsigned strict = (candidate < columns[5]).lanes();
    alignas(64) double when[Vector::width];
    candidate.store(when);
    for (unsigned k = 0; k < Vector::width && first + k < far; ++k) {
      const unsigned lane = batch.far_lane[first + k];
      const double before = batch.soonest[lane];
      const unsigned same = when[k] == before, some = when[k] < never, sooner = when[k] < before;
      doubtful |= ((same & some) | (sooner & ~(strict >> k))) << lane;
      batch.partner[lane] = sooner ? batch.far_slot[first + k] : batch.partner[lane];
      batch.soonest[lane] = sooner ? when[k] : before;
    }
  }
  batch.doubtful = doubtful;
}

/// Expiry of the list and transit, as in `schedule`.
[[gnu::always_inline]] inline void Strip::foresee_all_else() {
  Batch& batch = batch_;
  const Vector zero = Vector::all(0), transit = Vector::all(box_.transit);
  const double unit = neighbours_.grid().unit();
  alignas(64) double home_x[Batch::lanes], home_y[Batch::lanes], horizon[Batch::lanes];
  for (unsigned lane = 0; lane < Batch::lanes; ++lane) {
    home_x[lane] = unit * static_cast<std::uint32_t>(batch.centre[lane]);
    home_y[lane] = unit * static_cast<std::uint32_t>(batch.centre[lane] >> 32);
    horizon[lane] = calendar_.horizon(batch.slot[lane]);
  }
  unsigned transits = 0;
  for (unsigned lane = 0; lane < Batch::lanes; lane += Vector::width) {
    const Vector vx = Vector::load(batch.vx + lane), vy = Vector::load(batch.vy + lane);
    const Vector from = Vector::load(batch.flown_to + lane);
    const Vector dx = nearest(Vector::load(batch.x + lane) - Vector::load(home_x + lane), box_);
    const Vector dy = nearest(Vector::load(batch.y + lane) - Vector::load(home_y + lane), box_);
    const Vector vv = fma(vx, vx, vy * vy), dv = fma(dx, vx, dy * vy);
    const Vector room = Vector::load(batch.leash_squared + lane) - fma(dx, dx, dy * dy);
    const Vector expiry = from + (sqrt(max(fma(dv, dv, vv * room), zero)) - dv) / vv;
    const Vector review = choose(expiry < Vector::load(batch.soonest + lane), min(expiry, Vector::load(horizon + lane)),
                                 Vector::all(never));
    const Vector away = from + transit / max(max(vx, zero - vx), max(vy, zero - vy));
    const Mask moved = away < review;
    choose(moved, away, review).store(batch.otherwise + lane);
    transits |= moved.lanes() << lane;
  }
  batch.transits = transits;
}

/// Writes the events, in order, as long as nothing else comes before the next: the first at least.
[[gnu::always_inline]] inline void Strip::carry_out_batch() {
  Batch& batch = batch_;
  Record* const records = records_;
  ColdRecord* const cold = cold_;
  const unsigned not_plain = batch.doubtful | batch.special;
  std::uint64_t orphans = 0;
  unsigned entered = 0;
  double soonest = never;  // of what has been entered
  auto enter = [&](double t, std::uint32_t i, bool really) SANDGLASS_INLINE {
    batch.entry_time[entered] = t;
    batch.entry_slot[entered] = i;
    entered += really;
    soonest = t < soonest ? t : soonest;
  };
  auto write = [&](std::uint32_t i, unsigned lane, double t) SANDGLASS_INLINE {
    Record& disk = records[i];
    disk.x = batch.x[lane], disk.y = batch.y[lane], disk.vx = batch.vx[lane], disk.vy = batch.vy[lane];
    disk.time = t;
    set_next(disk, never, Next::review, no_disk);
    cold[i].last_contact = t;
    if ((batch.wrapped >> lane & 1) != 0) [[unlikely]] {
      images_[i].x += static_cast<std::int32_t>(batch.image_x[lane]);
      images_[i].y += static_cast<std::int32_t>(batch.image_y[lane]);
    }
  };
  // `settle`, without branches where it cannot be foretold which way they go
  auto settle_batched = [&](std::uint32_t i, unsigned lane) SANDGLASS_INLINE {
    const double contact = batch.soonest[lane], otherwise = batch.otherwise[lane];
    const std::uint32_t partner = batch.partner[lane];  // if it meets; chosen here, it would become a branch
    const bool meets = contact <= otherwise;
    const double t = meets ? contact : otherwise;
    Record& other = meets ? records[partner] : batch.nobody;
    if ((not_plain >> lane & 1) != 0 || !(t < other.next_time)) [[unlikely]]
      return predict(i);
    const std::uint32_t lost_slot = other.partner;
    const bool loses = lost_slot != no_disk;
    Record& lost = loses ? records[lost_slot] : batch.nobody;
    enter(other.next_time, lost_slot, loses && other.next == Next::contact);  // as in `leave_partner`
    lost.next = Next::review;
    lost.partner = no_disk;
    orphans += loses;
    set_next(other, t, Next::contact_entered_by_partner, i);
    set_next(batch.nobody, never, Next::review, no_disk);
    const bool transit = batch.transits >> lane & 1;
    set_next(records[i], t, meets ? Next::contact : transit ? Next::transit : Next::review, meets ? partner : no_disk);
    enter(t, i, true);
  };

  unsigned m = 0, taken = 0;
  for (; m < batch.count; ++m) {
    const double t = batch.time[m];
    if (calendar_.late_soonest() <= t || soonest <= t) [[unlikely]]
      break;
    taken = batch.entries[m];
    const std::uint32_t i = batch.slot[m], j = batch.slot[m + Batch::size];
    assert(records[i].next_time == t && owns(i));
    if (--until_stall_check_ == 0) [[unlikely]]
      check_progress(t);
    if (!batch.contact[m]) {
      set_next(records[i], never, Next::review, no_disk);
      settle_batched(i, m);
      continue;
    }
    write(i, m, t);
    write(j, m + Batch::size, t);
    ++tally_.contacts[records[i].species + records[j].species];
    tally_.elastic_contacts += batch.elastic[m];
    if (log) [[unlikely]]
      ids_[i] < ids_[j] ? log_event(EventKind::contact, t, i, j) : log_event(EventKind::contact, t, j, i);
    settle_batched(i, m);
    settle_batched(j, m + Batch::size);
  }
  calendar_.take_ahead(taken);
  for (unsigned n = 0; n < entered; ++n) enter_event(batch.entry_time[n], batch.entry_slot[n]);
  for (unsigned k = m; k < Batch::size; ++k) batch.virial[k] = batch.dissipated[k] = 0;
  tally_.virial.add(batch.virial);
  tally_.dissipated.add(batch.dissipated);
  bookkeeping_.orphans += orphans;
  bookkeeping_.predictions += batch.searches;
}

#undef SANDGLASS_INLINE

#else

bool Strip::run_batch() { return false; }

#endif

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
