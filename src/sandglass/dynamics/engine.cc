// The hot loop. Invariants, at every moment between two events:
//  1. A record is as its disk's own last contact, kick, transit or epoch left it. Nothing else writes to its flight.
//  2. A foreseen contact is mutual: both disks name each other, with the same time.
//  3. No disk's next event comes later, in canonical order, than its own kick, its transit or the expiry of its list;
//  and
//     no contact of a listed pair, as computed from the records as they are now, comes before the next events of both
//     its disks. So the earliest next event of all is the earliest event there is.
//  4. Every finite next event has an entry in the calendar, a contact at least one for the pair.
//  5. Two disks that overlap or touch are in each other's lists; lists are symmetric.
#include "sandglass/dynamics/engine.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "sandglass/dynamics/calendar.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/drive.h"
#include "sandglass/dynamics/epoch.h"
#include "sandglass/dynamics/neighbours.h"
#include "sandglass/dynamics/record.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

class IsaEngine final : public Engine {
 public:
  IsaEngine(State& state, const Tuning& tuning)
      : state_(state), tuning_(tuning), box_(state.box_length, state.mixture) {
    for (const int a : {small, big})
      for (const int b : {small, big}) masses_[a][b] = PairMasses(state.mixture.mass[a], state.mixture.mass[b]);
  }

  OverlappingPair load(const std::uint32_t* order) override;
  void store(Disk* disks) const override;
  void run(double end) override;
  void make_frame(double* x, double* y, double* vx, double* vy) const override;

 private:
  void on_contact(std::uint32_t i, std::uint32_t j, double t);
  void on_kick(std::uint32_t i, double t);
  void on_transit(std::uint32_t i, double t);
  void on_list_expiry(std::uint32_t i, double t);

  void check_progress(double t);

  void predict_pending();
  void predict(std::uint32_t i);
  struct Foreseen {
    double time;
    std::uint32_t partner;
  };
  [[nodiscard]] Foreseen earliest_contact(std::uint32_t i) const;
  void orphan(std::uint32_t i);
  void release(std::uint32_t i);
  [[nodiscard]] bool comes_before_next_of(const Record& other, double t, std::uint32_t i) const;
  [[nodiscard]] double list_expiry(const Record& disk, const ColdRecord& cold) const;
  [[nodiscard]] bool within_leash(const Record& disk, const ColdRecord& cold, double t) const;

  std::uint32_t nearest_partner(std::uint32_t i, double t);
  std::uint32_t partner_within_reach(std::uint32_t i, double t, const Kick& kick);

  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const;
  void log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const;
  [[nodiscard]] double mean_lead() const;
  [[nodiscard]] double default_skin() const;

  [[nodiscard]] double inverse_mass(const Record& disk) const { return masses_[disk.species][disk.species].inverse_a; }
  [[nodiscard]] double largest_radius() const { return box_.length / 4 - box_.transit; }

  State& state_;
  Tuning tuning_;
  Box box_;
  PairMasses masses_[species_count][species_count];  // by species of the first and the second disk
  std::size_t size_ = 0;
  Array<Record> records_;
  Array<ColdRecord> cold_;
  Neighbours neighbours_;
  Calendar calendar_;
  std::uint64_t until_stall_check_ = 1;
  double progress_time_ = -never;
  GrowingArray<std::uint32_t> pending_;  // disks without a next event, to be predicted before time goes on
  GrowingArray<DiskName> candidates_;    // possible partners of a kick
};

void IsaEngine::run(double end) {
  for (;;) {
    const std::uint32_t i =
        calendar_.pop(&records_[0], end, [this](std::uint32_t a, std::uint32_t b) { return before(a, b); });
    if (i == no_disk) break;
    const Record& disk = records_[i];
    const double t = disk.next_time;
    if (--until_stall_check_ == 0) [[unlikely]]
      check_progress(t);
    switch (disk.next) {
      case Next::contact:
        on_contact(i, disk.partner, t);
        break;
      case Next::kick:
        on_kick(i, t);
        break;
      case Next::transit:
        on_transit(i, t);
        break;
      case Next::list_expiry:
        on_list_expiry(i, t);
        break;
    }
  }
  state_.now = end;
}

/// In an inelastic collapse infinitely many collisions take place in a finite time, and the loop would never end. After
/// 64 events per disk (and a million at least) time must have gone on by more than a billionth of a mean free time.
void IsaEngine::check_progress(double t) {
  if (t - progress_time_ < 1e-9 * state_.epoch_length / beats_per_epoch) report_collapse(state_, t);
  progress_time_ = t;
  until_stall_check_ = (std::uint64_t{1} << 20) + 64 * size_;
}

void IsaEngine::on_contact(std::uint32_t i, std::uint32_t j, double t) {
  if (cold_[i].id > cold_[j].id) std::swap(i, j);
  Record &a = records_[i], &b = records_[j];
  ColdRecord &cold_a = cold_[i], &cold_b = cold_[j];
  advance(a, cold_a.image_x, cold_a.image_y, t, box_);
  advance(b, cold_b.image_x, cold_b.image_y, t, box_);

  const CollisionLaw& law = state_.collision;
  const bool elastic = elastic_by_tc(law, t, cold_a.last_contact, cold_b.last_contact);
  const Impact impact = collide(a, b, masses_[a.species][b.species], elastic ? 1.0 : law.restitution, box_);
  cold_a.last_contact = cold_b.last_contact = t;

  Tally& tally = state_.tally;
  ++tally.contacts[a.species + b.species];
  tally.elastic_contacts += elastic;
  tally.virial.add(impact.virial);
  tally.dissipated.add(impact.dissipated);
  if (log) [[unlikely]]
    log_event(EventKind::contact, t, i, j);
  release(i);
  predict_pending();
}

void IsaEngine::on_kick(std::uint32_t i, double t) {
  Record& disk = records_[i];
  ColdRecord& cold = cold_[i];
  const Kick kick = Kick::draw(state_.seed, cold.id, ++cold.kick_count);
  cold.next_kick = t + kick.wait / clock_rate(state_.drive);

  Tally& tally = state_.tally;
  const bool pair = state_.drive.kind == DriveKind::pair;
  std::uint32_t j = no_disk;
  if (pair) {
    j = state_.drive.partner == PartnerRule::nearest ? nearest_partner(i, t) : partner_within_reach(i, t, kick);
    if (j == no_disk) {
      ++tally.kicks_without_partner;
      if (log) log_event(EventKind::kick, t, i, j);
      release(i);
      predict_pending();
      return;
    }
  }
  ++tally.kicks;
  const double px = state_.drive.amplitude * kick.px, py = state_.drive.amplitude * kick.py;
  advance(disk, cold.image_x, cold.image_y, t, box_);
  double gained = give_momentum(disk, px, py, inverse_mass(disk));
  ++tally.kicked[disk.species];
  if (pair) {
    Record& partner = records_[j];
    advance(partner, cold_[j].image_x, cold_[j].image_y, t, box_);
    gained += give_momentum(partner, -px, -py, inverse_mass(partner));
    ++tally.kicked[partner.species];
  }
  tally.injected.add(gained);
  if (log) [[unlikely]]
    log_event(EventKind::kick, t, i, j);
  release(i);
  if (pair) release(j);
  predict_pending();
}

void IsaEngine::on_transit(std::uint32_t i, double t) {
  advance(records_[i], cold_[i].image_x, cold_[i].image_y, t, box_);
  ++state_.tally.transits;
  if (log) log_event(EventKind::transit, t, i, no_disk);
  release(i);
  predict_pending();
}

/// Makes the list of disk i anew around where it is at time t. Its record does not change.
void IsaEngine::on_list_expiry(std::uint32_t i, double t) {
  ++bookkeeping.list_rebuilds;
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n) neighbours_.remove(list[n], i, &records_[0]);
  records_[i].neighbour_count = 0;
  neighbours_.displace(i, &cold_[0]);

  Record now = records_[i];
  std::int32_t image_x = 0, image_y = 0;
  advance(now, image_x, image_y, t, box_);
  cold_[i].centre_x = now.x;
  cold_[i].centre_y = now.y;
  const double range = now.radius + largest_radius() + neighbours_.skin();
  neighbours_.visit_near(now.x, now.y, range, &cold_[0], [&](std::uint32_t k) {
    if (!neighbours_.listed(&records_[0], &cold_[0], i, k)) return;
    neighbours_.add(i, k, &records_[0]);
    neighbours_.add(k, i, &records_[0]);
  });
  neighbours_.place(i, &cold_[0]);

  // Nobody names i, whose next event was this; so nobody who has left its list does.
  release(i);
  predict_pending();
}

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

/// The disk with the smallest gap of surfaces to disk i at time t; the smaller id at equal gaps.
std::uint32_t IsaEngine::nearest_partner(std::uint32_t i, double t) {
  const Record& disk = records_[i];
  double best_gap = never;
  std::uint32_t best = no_disk;
  auto visit = [&](std::uint32_t k) {
    if (k == i) return;
    const double gap = surface_gap(disk, records_[k], disk.radius + records_[k].radius, t, box_);
    if (gap < best_gap || (gap == best_gap && best != no_disk && cold_[k].id < cold_[best].id)) {
      best_gap = gap;
      best = k;
    }
  };
  const std::uint32_t* const list = neighbours_.list(i);
  for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) visit(list[n]);

  // Unlisted disks have list centres at least R_i + R_j + skin from ours; each of the two has moved from its own.
  const double x = std::fma(disk.vx, t - disk.time, disk.x), y = std::fma(disk.vy, t - disk.time, disk.y);
  const double dx = box_.nearest(x - cold_[i].centre_x), dy = box_.nearest(y - cold_[i].centre_y);
  const double moved = std::sqrt(dx * dx + dy * dy);
  if (best_gap < neighbours_.skin() - neighbours_.leash() - moved - 1e-9) return best;

  ++bookkeeping.wide_partner_searches;
  const double margin = disk.radius + largest_radius() + neighbours_.leash() + 1e-9;
  for (double radius = margin + neighbours_.skin();; radius *= 1.5) {
    if (best != no_disk && best_gap + margin < radius) radius = best_gap + margin;
    const bool all = neighbours_.visit_near(x, y, radius, &cold_[0], visit);
    if (all || best_gap + margin <= radius) return best;
  }
}

/// One of the disks whose centres are within reach * (R_i + R_j) of disk i at time t, picked by the kick's own random
/// number in the order of ids; no_disk if there are none.
std::uint32_t IsaEngine::partner_within_reach(std::uint32_t i, double t, const Kick& kick) {
  const Record& disk = records_[i];
  candidates_.clear();
  auto visit = [&](std::uint32_t k) {
    if (k == i) return;
    if (!within_reach(disk, records_[k], disk.radius + records_[k].radius, state_.drive.reach, t, box_)) return;
    candidates_.push_back({cold_[k].id, k});
  };
  const double x = std::fma(disk.vx, t - disk.time, disk.x), y = std::fma(disk.vy, t - disk.time, disk.y);
  const double radius = state_.drive.reach * (disk.radius + largest_radius()) + neighbours_.leash() + 1e-9;
  neighbours_.visit_near(x, y, radius, &cold_[0], visit);
  if (candidates_.empty()) return no_disk;
  return nth_by_id(candidates_.begin(), candidates_.end(), kick.pick(candidates_.size())).slot;
}

/// Canonical order of two disks' next events at one time: kind, then ids. (List expiry, no event, comes last.)
bool IsaEngine::before(std::uint32_t a, std::uint32_t b) const {
  const Record &disk_a = records_[a], &disk_b = records_[b];
  if (disk_a.next != disk_b.next) return disk_a.next < disk_b.next;
  auto ids = [&](std::uint32_t slot, const Record& disk) {
    const std::uint64_t own = cold_[slot].id;
    const std::uint64_t other = disk.partner == no_disk ? no_disk : cold_[disk.partner].id;
    return own < other ? own << 32 | other : other << 32 | own;
  };
  return ids(a, disk_a) < ids(b, disk_b);
}

void IsaEngine::log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const {
  append_event(*log, {t, kind, cold_[i].id, j == no_disk ? no_disk : cold_[j].id});
}

OverlappingPair IsaEngine::load(const std::uint32_t* order) {
  size_ = state_.disks.size();
  until_stall_check_ = 1;
  progress_time_ = -never;
  const Disk* const disks = state_.disks.data();
  if (records_.size() != size_) {
    records_ = Array<Record>(size_);
    cold_ = Array<ColdRecord>(size_);
  }
  const double skin = default_skin();
  const double widest = 2 * largest_radius() + skin;
  neighbours_ = Neighbours(size_, box_, skin, tuning_.cell_size > 0 ? tuning_.cell_size : widest);
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Disk& disk = disks[order[i]];
    records_[i] = {disk.x,  disk.y,        disk.vx,      disk.vy, disk.time, never, state_.mixture.radius[disk.species],
                   no_disk, Next::contact, disk.species, 0};
    Record now = records_[i];
    std::int32_t image_x = 0, image_y = 0;
    advance(now, image_x, image_y, state_.now, box_);
    cold_[i] = {now.x, now.y,  disk.last_contact, disk.next_kick, disk.kick_count, disk.image_x, disk.image_y, order[i],
                0,     no_disk};
  }
  OverlappingPair deepest;
  for (std::uint32_t i = 0; i < size_; ++i) {
    neighbours_.visit_near(cold_[i].centre_x, cold_[i].centre_y, widest, &cold_[0], [&](std::uint32_t k) {
      if (!neighbours_.listed(&records_[0], &cold_[0], i, k)) return;
      neighbours_.add(i, k, &records_[0]);
      neighbours_.add(k, i, &records_[0]);
      const double contact = records_[i].radius + records_[k].radius;
      const double gap = surface_gap(records_[i], records_[k], contact, state_.now, box_);
      if (gap < -1e-9 * contact && -gap > deepest.depth) deepest = {cold_[k].id, cold_[i].id, -gap};
    });
    neighbours_.place(i, &cold_[0]);
  }

  // First predictions into a calendar of arbitrary scale, only to learn how far ahead events are.
  calendar_ = Calendar(state_.now, state_.epoch_length, 0);
  for (std::uint32_t i = 0; i < size_; ++i) {
    predict(i);
    predict_pending();
  }
  const double events = tuning_.bucket_events > 0 ? tuning_.bucket_events : 3;
  calendar_ = Calendar(state_.now, events * mean_lead() / static_cast<double>(size_), size_);
  for (std::uint32_t i = 0; i < size_; ++i)
    if (records_[i].next_time < never) calendar_.push(records_[i].next_time, i);
  return deepest;
}

/// Width of the lists beyond contact: a circle of that range holds about eight centres at the given density.
double IsaEngine::default_skin() const {
  const double room = box_.length / 2 - 2 * largest_radius();  // wider, and nearest images would no longer be unique
  if (tuning_.skin > 0) return std::fmin(tuning_.skin, room);
  const double area_per_disk = box_.length * box_.length / static_cast<double>(size_);
  const double contact = state_.mixture.radius[small] + state_.mixture.radius[big];
  const double skin = std::sqrt(8 * area_per_disk / 3.14159) - contact;
  return std::fmin(std::fmax(skin, 0.2 * contact), room);
}

/// About the mean time from now to a disk's next event, from the median over a sample of disks: the median of an
/// exponential distribution is ln 2 of its mean.
double IsaEngine::mean_lead() const {
  const std::size_t step = size_ / 1024 + 1;
  double low = 0, high = state_.epoch_length;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    std::size_t below = 0, all = 0;
    for (std::size_t slot = 0; slot < size_; slot += step, ++all)
      below += records_[slot].next_time - state_.now < middle;
    (2 * below < all ? low : high) = middle;
  }
  return std::fmax(high, 1e-9 * state_.epoch_length) / 0.69;
}

void IsaEngine::store(Disk* disks) const {
  for (std::size_t i = 0; i < size_; ++i) {
    const Record& record = records_[i];
    const ColdRecord& cold = cold_[i];
    Disk& disk = disks[cold.id];
    disk.x = record.x;
    disk.y = record.y;
    disk.vx = record.vx;
    disk.vy = record.vy;
    disk.time = record.time;
    disk.last_contact = cold.last_contact;
    disk.next_kick = cold.next_kick;
    disk.kick_count = cold.kick_count;
    disk.image_x = cold.image_x;
    disk.image_y = cold.image_y;
    disk.species = record.species;
  }
}

void IsaEngine::make_frame(double* x, double* y, double* vx, double* vy) const {
  for (std::size_t i = 0; i < size_; ++i) {
    const Record& record = records_[i];
    const ColdRecord& cold = cold_[i];
    const double flight = state_.now - record.time;
    x[cold.id] = record.x + record.vx * flight + cold.image_x * box_.length;
    y[cold.id] = record.y + record.vy * flight + cold.image_y * box_.length;
    vx[cold.id] = record.vx;
    vy[cold.id] = record.vy;
  }
}

}  // namespace
}  // namespace SANDGLASS_ISA

#define SANDGLASS_JOIN_(a, b) a##b
#define SANDGLASS_JOIN(a, b) SANDGLASS_JOIN_(a, b)
Engine* SANDGLASS_JOIN(make_engine_, SANDGLASS_ISA)(State& state, const Tuning& tuning) {
  return new IsaEngine(state, tuning);
}

}  // namespace sandglass
