// What comes next for a disk: its earliest contact, kick, transit or list expiry.
#include <cmath>

#include "sandglass/dynamics/isa_engine.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Leaves disk i without a next event, to be predicted anew.
void IsaEngine::orphan(std::uint32_t i) {
  records_[i].partner = no_disk;
  records_[i].next_time = never;
  pending_.push_back(i);
}

/// The same for disk i and for its partner, if its next event is a contact.
void IsaEngine::release(std::uint32_t i) {
  const std::uint32_t partner = records_[i].partner;
  orphan(i);
  if (partner != no_disk) orphan(partner);
}

void IsaEngine::predict_pending() {
  while (!pending_.empty()) {
    const std::uint32_t i = pending_.back();
    pending_.pop_back();
    predict(i);
  }
}

/// Whether a contact at time t of disk i with `other` comes before what `other` has next, in canonical order: contacts
/// come before anything else at the same time, and among contacts of one disk that with the smaller id comes first.
bool IsaEngine::comes_before_next_of(const Record& other, double t, std::uint32_t i) const {
  if (t != other.next_time) return t < other.next_time;
  return other.partner == no_disk || other.partner == i || cold_[i].id < cold_[other.partner].id;
}

/// The earliest contact of disk i with a listed disk for which it also comes before what that disk has next.
IsaEngine::Foreseen IsaEngine::earliest_contact(std::uint32_t i) const {
  Foreseen earliest{never, no_disk};
  const Record& disk = records_[i];
  const std::uint32_t* const list = neighbours_.list(i);
  auto consider = [&](std::uint32_t k, double t) {
    if (t > earliest.time || t == never || !comes_before_next_of(records_[k], t, i)) return;
    if (t == earliest.time && cold_[earliest.partner].id < cold_[k].id) return;
    earliest = {t, k};
  };
#ifdef SANDGLASS_SIMD
  // contact_time, lane by lane: the same operations in the same order.
  const Vector x = Vector::all(disk.x), y = Vector::all(disk.y), vx = Vector::all(disk.vx), vy = Vector::all(disk.vy);
  const Vector time = Vector::all(disk.time), radius = Vector::all(disk.radius);
  const Vector length = Vector::all(box_.length), inverse = Vector::all(box_.inverse), zero = Vector::all(0);
  auto nearest = [&](Vector difference) { return fnma(length, nearest_integer(difference * inverse), difference); };
  for (std::uint32_t first = 0; first < disk.neighbour_count; first += Vector::width) {
    const Record* rows[Vector::width];
    for (std::uint32_t n = 0; n < Vector::width; ++n)  // lanes without a neighbour hold the disk itself: never
      rows[n] = &records_[first + n < disk.neighbour_count ? list[first + n] : i];
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
    if (!(soonest <= earliest.time) || soonest == never) continue;
    // One lane, before its own next event, is the rule; ties of any kind are left to the scalar rule.
    const unsigned lanes = (candidate == Vector::all(soonest)).lanes();
    const unsigned strict = (candidate < other[5]).lanes();
    if ((lanes & (lanes - 1)) == 0 && (lanes & strict) != 0 && soonest < earliest.time) [[likely]] {
      earliest = {soonest, list[first + static_cast<unsigned>(__builtin_ctz(lanes))]};
    } else {
      for (unsigned n = 0; n < Vector::width && first + n < disk.neighbour_count; ++n) {
        const Record& neighbour = records_[list[first + n]];
        consider(list[first + n], contact_time(disk, neighbour, disk.radius + neighbour.radius, box_));
      }
    }
  }
#else
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
    const Record& neighbour = records_[list[n]];
    consider(list[n], contact_time(disk, neighbour, disk.radius + neighbour.radius, box_));
  }
#endif
  return earliest;
}

/// Finds what comes next for disk i and enters it into the calendar. A contact is taken only if it also comes before
/// what the other disk has next; the other's old partner, if any, is then to be predicted anew.
void IsaEngine::predict(std::uint32_t i) {
  ++bookkeeping.predictions;
  Record& disk = records_[i];
  const ColdRecord& cold = cold_[i];
  auto [next_time, partner] = earliest_contact(i);
  Next next = Next::contact;
  auto consider = [&](double t, Next what) {
    if (t < next_time) next_time = t, next = what, partner = no_disk;
  };
  consider(cold.next_kick, Next::kick);
  // Transit and expiry cost a division and a root; most often it is plain that they do not come first.
  const double speed_x = std::fabs(disk.vx), speed_y = std::fabs(disk.vy);
  const double speed = speed_x > speed_y ? speed_x : speed_y;
  if (speed * (next_time - disk.time) > 0.999 * box_.transit) consider(transit_time(disk, box_), Next::transit);
  if (!within_leash(disk, cold, next_time)) consider(list_expiry(disk, cold), Next::list_expiry);

  if (partner != no_disk && partner == disk.partner) return;  // it has chosen i already
  if (disk.partner != no_disk) orphan(disk.partner);
  disk.next_time = next_time;
  disk.next = next;
  disk.partner = partner;
  if (partner != no_disk) {
    Record& other = records_[partner];
    if (other.partner != no_disk) {
      ++bookkeeping.orphans;
      orphan(other.partner);
    }
    other.next_time = next_time;
    other.next = Next::contact;
    other.partner = i;
  }
  if (next_time < never) calendar_.push(next_time, i);
}

/// Whether the disk, flying freely, is still within the leash of its list centre at time t.
bool IsaEngine::within_leash(const Record& disk, const ColdRecord& cold, double t) const {
  const double flight = t - disk.time;
  const double dx = box_.nearest(disk.x - cold.centre_x) + disk.vx * flight;
  const double dy = box_.nearest(disk.y - cold.centre_y) + disk.vy * flight;
  return dx * dx + dy * dy < 0.999 * neighbours_.leash() * neighbours_.leash();
}

/// When the disk, flying freely, leaves the circle of its leash: the later root, since its record may be older than its
/// list and lie outside on the other side.
double IsaEngine::list_expiry(const Record& disk, const ColdRecord& cold) const {
  const double dx = box_.nearest(disk.x - cold.centre_x), dy = box_.nearest(disk.y - cold.centre_y);
  const double vv = disk.vx * disk.vx + disk.vy * disk.vy;
  if (vv == 0) return never;
  const double dv = dx * disk.vx + dy * disk.vy;
  const double c = neighbours_.leash() * neighbours_.leash() - dx * dx - dy * dy;
  return disk.time + (std::sqrt(std::fmax(dv * dv + vv * c, 0.0)) - dv) / vv;
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
