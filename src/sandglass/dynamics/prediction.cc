// What comes next for a disk: its earliest contact, kick, transit or list expiry.
#include <cmath>

#include "sandglass/dynamics/contact_vector.h"
#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Predicts what comes next for disk i, whose flight or list is new.
void Strip::predict(std::uint32_t i) { schedule(i, earliest_contact(i)); }

/// The same after a search that was begun before other disks were settled.
[[gnu::always_inline]] inline void Strip::settle(std::uint32_t i, Lanes begun) {
  Foreseen contact = earliest_of_blocks(i, begun);
  if (contact.partner != no_disk && !comes_before_next_of(records_[contact.partner], contact.time, i)) [[unlikely]]
    contact = earliest_contact(i);
  schedule(i, contact);
}

/// Enters what comes next for disk i into the calendar.
[[gnu::always_inline]] inline void Strip::enter_event(double t, std::uint32_t i) {
  if (t > outbox_from_) [[unlikely]]
    outbox_.push_back({t, i, 0});
  else
    calendar_.push(t, i);
}

/// Enters what comes next for disk i, and its next kick, into an empty calendar.
void Strip::enter_calendar(std::uint32_t i) {
  const Record& disk = records_[i];
  if (disk.next_time < never && disk.next != Next::contact_entered_by_partner) calendar_.push(disk.next_time, i);
  if (cold_[i].next_kick < never && cold_[i].next_kick != disk.next_time) calendar_.push(cold_[i].next_kick, i);
}

/// Disk i has lost the partner of its contact at time t. It looks for another when the contact would have come: whoever
/// meets it before will have found it.
void Strip::lose_partner(std::uint32_t i, double t, bool entered_by_partner) {
  ++bookkeeping_.orphans;
  if (entered_by_partner) enter_event(t, i);
  records_[i].next = Next::review;
  records_[i].partner = no_disk;
}

/// The partner of a disk's contact loses it. All there is to know stands in the disk's own record; the partner's, which
/// may be far from the processor, is not read.
void Strip::leave_partner(const Record& disk) {
  lose_partner(disk.partner, disk.next_time, disk.next == Next::contact);
}

/// Whether a contact at time t of disk i with `other` comes before what `other` has next, in canonical order: contacts
/// come before anything else at the same time, and among contacts of one disk that with the smaller id comes first.
bool Strip::comes_before_next_of(const Record& other, double t, std::uint32_t i) const {
  if (t != other.next_time) return t < other.next_time;
  return other.partner == no_disk || other.partner == i || ids_[i] < ids_[other.partner];
}

/// By the rule, one by one.
Strip::Foreseen Strip::earliest_contact_by_rule(std::uint32_t i) const {
  Foreseen earliest{never, no_disk};
  const Record& disk = records_[i];
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
    const std::uint32_t k = neighbours_.listed(i, n);
    const double t = contact_time(disk, records_[k], disk.radius + records_[k].radius, box_);
    if (t > earliest.time || t == never || !comes_before_next_of(records_[k], t, i)) continue;
    if (t == earliest.time && ids_[earliest.partner] < ids_[k]) continue;
    earliest = {t, k};
  }
  return earliest;
}

#ifdef SANDGLASS_SIMD

/// One disk with one block of its list. `amend` may change the columns of the listed records, and says which lanes
/// count.
template <class Amend>
[[gnu::always_inline]] inline Strip::Lanes Strip::contacts_of_block(const Flight& disk, double disk_radius,
                                                                    const std::uint32_t* list, Amend&& amend) const {
  const FlightColumns columns{Vector::all(disk.x),  Vector::all(disk.y),    Vector::all(disk.vx),
                              Vector::all(disk.vy), Vector::all(disk.time), Vector::all(disk_radius)};
  Vector other[8];
  load_columns(records_, list, other);
  const Mask counts = amend(other);
  const Vector candidate = contact_times(columns, other, counts, box_);
  const double soonest = smallest(candidate);
  return {soonest, (candidate == Vector::all(soonest)).lanes(), (candidate < other[5]).lanes()};
}

Strip::Lanes Strip::first_contacts(std::uint32_t i, const Flight& flight, std::uint32_t except) const {
  const std::uint32_t* const list = neighbours_.list(i);
  return contacts_of_block(flight, records_[i].radius, list, [&](Vector(&)[8]) { return other_than(list, except); });
}

/// The same where disk `other` has a new flight, too, which is not yet in its record.
Strip::Lanes Strip::first_contacts(std::uint32_t i, const Flight& flight, std::uint32_t other,
                                   const Flight& other_flight) const {
  const std::uint32_t* const list = neighbours_.list(i);
  return contacts_of_block(flight, records_[i].radius, list, [&](Vector(&columns)[8]) {
    const double now[6] = {other_flight.x, other_flight.y, other_flight.vx, other_flight.vy, other_flight.time, never};
    const Mask others = other_than(list, other);
    for (int c = 0; c < 6; ++c) columns[c] = choose(others, columns[c], Vector::all(now[c]));
    return everywhere();
  });
}

/// The earliest of all blocks, the first of which is done.
[[gnu::always_inline]] inline Strip::Foreseen Strip::earliest_of_blocks(std::uint32_t i, Lanes lanes) const {
  Foreseen earliest{never, no_disk};
  const Record& disk = records_[i];
  const std::uint32_t* list = neighbours_.list(i);
  for (std::uint32_t first = 0;;) {
    if (lanes.soonest < earliest.time) {
      // One lane, before its own next event, is the rule. At the time of that event: disks that have chosen each other.
      if ((lanes.all & (lanes.all - 1)) != 0) [[unlikely]]
        return earliest_contact_by_rule(i);
      earliest = {lanes.soonest, list[static_cast<unsigned>(__builtin_ctz(lanes.all))]};
      if ((lanes.all & lanes.strict) == 0 && !comes_before_next_of(records_[earliest.partner], earliest.time, i))
          [[unlikely]]
        return earliest_contact_by_rule(i);
    } else if (lanes.soonest == earliest.time && earliest.time < never) [[unlikely]] {
      return earliest_contact_by_rule(i);
    }
    first += Vector::width;
    if (first >= disk.neighbour_count) return earliest;
    list = neighbours_.list_from(i, first);
    lanes = contacts_of_block(Flight(disk), disk.radius, list, [](Vector(&)[8]) { return everywhere(); });
  }
}

#else

Strip::Lanes Strip::first_contacts(std::uint32_t, const Flight&, std::uint32_t) const { return {}; }
Strip::Lanes Strip::first_contacts(std::uint32_t, const Flight&, std::uint32_t, const Flight&) const { return {}; }
Strip::Foreseen Strip::earliest_of_blocks(std::uint32_t i, Lanes) const { return earliest_contact_by_rule(i); }

#endif

Strip::Foreseen Strip::earliest_contact(std::uint32_t i) const {
  return earliest_of_blocks(i, first_contacts(i, Flight(records_[i]), no_disk));
}

/// Settles what comes next for disk i, given its earliest contact, and enters it into the calendar. A contact is taken
/// only if it also comes before what the other disk has next; both may have to part from others.
[[gnu::always_inline]] inline void Strip::schedule(std::uint32_t i, Foreseen contact) {
  ++bookkeeping_.predictions;
  Record& disk = records_[i];
  const ColdRecord& cold = cold_[i];
  double t = contact.time;
  Next next = Next::contact;
  auto consider = [&](double time, Next what) {
    if (time < t) t = time, next = what;
  };
  consider(cold.next_kick, Next::kick);
  if (disk.concerned) [[unlikely]]
    consider(freezing_time(i), Next::freeze);
  // Expiry and transit cost a root and divisions; most often it is plain that they do not come first.
  if (!within_leash(disk, cold, t)) consider(std::fmin(list_expiry(disk, cold), calendar_.horizon(i)), Next::review);
  const double speed_x = std::fabs(disk.vx), speed_y = std::fabs(disk.vy);
  const double speed = speed_x > speed_y ? speed_x : speed_y;
  if (!(speed * (t - disk.time) < 0.999 * box_.transit)) consider(transit_time(disk, box_), Next::transit);

  if (next == Next::contact && contact.partner == disk.partner) return;  // it has chosen i already, or nothing comes
  if (disk.partner != no_disk) leave_partner(disk);
  if (next == Next::contact) {
    if (contact.partner == no_disk) return;
    Record& other = records_[contact.partner];
    if (other.partner != no_disk) leave_partner(other);
    set_next(other, t, Next::contact_entered_by_partner, i);
  }
  set_next(disk, t, next, next == Next::contact ? contact.partner : no_disk);
  if (next == Next::kick) return enter_kick_again(i);
  enter_event(t, i);
}

/// Whether the disk, flying freely, is still plainly within the leash of its list centre at time t.
bool Strip::within_leash(const Record& disk, const ColdRecord& cold, double t) const {
  const Grid& grid = neighbours_.grid();
  const double flight = t - disk.time;
  const double dx = grid.offset(cold.centre.x, disk.x) + disk.vx * flight;
  const double dy = grid.offset(cold.centre.y, disk.y) + disk.vy * flight;
  return dx * dx + dy * dy < 0.999 * leash_[disk.roomy] * leash_[disk.roomy];
}

/// When the disk, flying freely, leaves the circle of its leash: the later root, since its record may be older than its
/// list and lie outside on the other side.
double Strip::list_expiry(const Record& disk, const ColdRecord& cold) const {
  const Grid& grid = neighbours_.grid();
  const double dx = grid.offset(cold.centre.x, disk.x), dy = grid.offset(cold.centre.y, disk.y);
  const double vv = disk.vx * disk.vx + disk.vy * disk.vy;
  if (vv == 0) return never;
  const double dv = dx * disk.vx + dy * disk.vy;
  const double leash = leash_[disk.roomy];
  const double square = dv * dv + vv * (leash * leash - dx * dx - dy * dy);
  return disk.time + (std::sqrt(square > 0 ? square : 0) - dv) / vv;
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
