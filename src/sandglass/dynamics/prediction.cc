// What comes next for a disk: its earliest contact, kick, transit or list expiry.
#include <cmath>

#include "sandglass/dynamics/isa_engine.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Predicts what comes next for disk i, whose flight or list is new.
void IsaEngine::predict(std::uint32_t i) { schedule(i, earliest_contact(i)); }

/// For two disks at once: the processor does the searches side by side.
void IsaEngine::predict(std::uint32_t i, std::uint32_t j) {
  auto [of_i, of_j] = earliest_contacts(i, j);
  schedule(i, of_i);
  if (of_j.partner != no_disk && !comes_before_next_of(records_[of_j.partner], of_j.time, j)) [[unlikely]]
    of_j = earliest_contact(j);  // i took what j was to meet
  schedule(j, of_j);
}

/// Disk i has lost the partner of its contact. It looks for another when the contact would have come: whoever meets it
/// before will have found it.
void IsaEngine::part(std::uint32_t i) {
  ++bookkeeping.orphans;
  set_next(records_[i], records_[i].next_time, Next::review, no_disk);
  calendar_.push(records_[i].next_time, i);  // the entry may name the other disk of the pair
}

/// Whether a contact at time t of disk i with `other` comes before what `other` has next, in canonical order: contacts
/// come before anything else at the same time, and among contacts of one disk that with the smaller id comes first.
bool IsaEngine::comes_before_next_of(const Record& other, double t, std::uint32_t i) const {
  if (t != other.next_time) return t < other.next_time;
  return other.partner == no_disk || other.partner == i || cold_[i].id < cold_[other.partner].id;
}

/// By the rule, one by one.
IsaEngine::Foreseen IsaEngine::earliest_contact_by_rule(std::uint32_t i) const {
  Foreseen earliest{never, no_disk};
  const Record& disk = records_[i];
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
    const std::uint32_t k = list[n];
    const double t = contact_time(disk, records_[k], disk.radius + records_[k].radius, box_);
    if (t > earliest.time || t == never || !comes_before_next_of(records_[k], t, i)) continue;
    if (t == earliest.time && cold_[earliest.partner].id < cold_[k].id) continue;
    earliest = {t, k};
  }
  return earliest;
}

#ifdef SANDGLASS_SIMD

/// One block of the list: contact_time, lane by lane, the same operations in the same order.
struct IsaEngine::Lanes {
  double soonest;
  unsigned all, strict;  // lanes with the soonest time; those that come strictly before what the other has next
};
[[gnu::always_inline]] inline IsaEngine::Lanes IsaEngine::contacts_of_block(const Record& disk,
                                                                            const std::uint32_t* list) const {
  const Vector x = Vector::all(disk.x), y = Vector::all(disk.y), vx = Vector::all(disk.vx), vy = Vector::all(disk.vy);
  const Vector time = Vector::all(disk.time), radius = Vector::all(disk.radius);
  const Vector length = Vector::all(box_.length), inverse = Vector::all(box_.inverse), zero = Vector::all(0);
  auto nearest = [&](Vector difference) { return fnma(length, nearest_integer(difference * inverse), difference); };
  const Record* rows[Vector::width];
  for (std::uint32_t n = 0; n < Vector::width; ++n) rows[n] = &records_[list[n]];
  Vector other[8];  // columns of the record: x, y, vx, vy, time, next_time, radius
  load_columns(rows, other);
  const Vector t = max(time, other[4]);
  const Vector flight = t - time, other_flight = t - other[4];
  const Vector rx = nearest(fma(other[2], other_flight, other[0]) - fma(vx, flight, x));
  const Vector ry = nearest(fma(other[3], other_flight, other[1]) - fma(vy, flight, y));
  const Vector ux = other[2] - vx, uy = other[3] - vy;
  const Vector ru = fma(rx, ux, ry * uy), contact = radius + other[6];
  const Vector c = fma(rx, rx, fms(ry, ry, contact * contact));
  const Vector discriminant = fms(ru, ru, fma(ux, ux, uy * uy) * c);
  const Mask touching = c <= zero;
  const Vector wait = choose(touching, zero, c / (sqrt(discriminant) - ru));
  const Vector when = t + wait;
  const Mask meets = (ru < zero) & (touching | (zero <= discriminant)) & (when <= other[5]);
  const Vector candidate = choose(meets, when, Vector::all(never));
  const double soonest = smallest(candidate);
  return {soonest, (candidate == Vector::all(soonest)).lanes(), (candidate < other[5]).lanes()};
}

/// The earliest of all blocks, the first of which is done.
[[gnu::always_inline]] inline IsaEngine::Foreseen IsaEngine::earliest_of_blocks(std::uint32_t i, Lanes lanes) const {
  Foreseen earliest{never, no_disk};
  const Record& disk = records_[i];
  const std::uint32_t* list = neighbours_.list(i);
  for (std::uint32_t first = 0;;) {
    if (lanes.soonest < earliest.time) {
      // One lane, before its own next event, is the rule.
      if ((lanes.all & (lanes.all - 1)) != 0 || (lanes.all & lanes.strict) == 0) [[unlikely]]
        return earliest_contact_by_rule(i);
      earliest = {lanes.soonest, list[static_cast<unsigned>(__builtin_ctz(lanes.all))]};
    } else if (lanes.soonest == earliest.time && earliest.time < never) [[unlikely]] {
      return earliest_contact_by_rule(i);
    }
    first += Vector::width;
    if (first >= disk.neighbour_count) return earliest;
    list += Vector::width;
    lanes = contacts_of_block(disk, list);
  }
}

IsaEngine::Foreseen IsaEngine::earliest_contact(std::uint32_t i) const {
  return earliest_of_blocks(i, contacts_of_block(records_[i], neighbours_.list(i)));
}

std::pair<IsaEngine::Foreseen, IsaEngine::Foreseen> IsaEngine::earliest_contacts(std::uint32_t i,
                                                                                 std::uint32_t j) const {
  const Lanes of_i = contacts_of_block(records_[i], neighbours_.list(i));
  const Lanes of_j = contacts_of_block(records_[j], neighbours_.list(j));
  return {earliest_of_blocks(i, of_i), earliest_of_blocks(j, of_j)};
}

#else

IsaEngine::Foreseen IsaEngine::earliest_contact(std::uint32_t i) const { return earliest_contact_by_rule(i); }
std::pair<IsaEngine::Foreseen, IsaEngine::Foreseen> IsaEngine::earliest_contacts(std::uint32_t i,
                                                                                 std::uint32_t j) const {
  return {earliest_contact_by_rule(i), earliest_contact_by_rule(j)};
}

#endif

/// Settles what comes next for disk i, given its earliest contact, and enters it into the calendar. A contact is taken
/// only if it also comes before what the other disk has next; both may have to part from others.
void IsaEngine::schedule(std::uint32_t i, Foreseen contact) {
  ++bookkeeping.predictions;
  Record& disk = records_[i];
  const ColdRecord& cold = cold_[i];
  if (cold.alone_time < contact.time) {
    if (disk.partner != no_disk) part(disk.partner);
    set_next(disk, cold.alone_time, cold.alone, no_disk);
    if (cold.alone_time < never) calendar_.push(cold.alone_time, i);
    return;
  }
  if (contact.partner == no_disk || contact.partner == disk.partner) return;  // never anything; it has chosen i already
  if (disk.partner != no_disk) part(disk.partner);
  Record& other = records_[contact.partner];
  if (other.partner != no_disk) part(other.partner);
  set_next(disk, contact.time, Next::contact, contact.partner);
  set_next(other, contact.time, Next::contact, i);
  calendar_.push(contact.time, i);
}

/// Finds when disk i, flying freely, is next due for anything but a contact: its kick, its transit, or the expiry of
/// its list, when it leaves the circle of its leash. That is the later root, since its record may be older than its
/// list and lie outside on the other side.
void IsaEngine::foresee_alone(std::uint32_t i) {
  const Record& disk = records_[i];
  ColdRecord& cold = cold_[i];
  cold.alone_time = cold.next_kick;
  cold.alone = Next::kick;
  const Grid& grid = neighbours_.grid();
  const double dx = grid.offset(cold.centre.x, disk.x), dy = grid.offset(cold.centre.y, disk.y);
  const double vv = disk.vx * disk.vx + disk.vy * disk.vy;
  const double dv = dx * disk.vx + dy * disk.vy;
  const double square = dv * dv + vv * (leash_ * leash_ - dx * dx - dy * dy);
  const double expiry = vv > 0 ? disk.time + (std::sqrt(square > 0 ? square : 0) - dv) / vv : never;
  if (expiry < cold.alone_time) {
    cold.alone_time = expiry;
    cold.alone = Next::review;
  }
  // A transit costs a division; most often it is plain that it does not come first.
  const double speed_x = std::fabs(disk.vx), speed_y = std::fabs(disk.vy);
  const double speed = speed_x > speed_y ? speed_x : speed_y;
  if (speed * (cold.alone_time - disk.time) < 0.999 * box_.transit) return;
  if (const double transit = transit_time(disk, box_); transit < cold.alone_time) {
    cold.alone_time = transit;
    cold.alone = Next::transit;
  }
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
