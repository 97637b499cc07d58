#include "sandglass/dynamics/reference.h"

#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/drive.h"
#include "sandglass/dynamics/epoch.h"
#include "sandglass/dynamics/start_check.h"

namespace sandglass {

Reference::Reference(State state) : state_(std::move(state)) { check_start(state_); }

void Reference::run_until(double end) {
  for (;;) {
    const double local = end - static_cast<double>(state_.epoch) * state_.epoch_length;
    const double limit = local < state_.epoch_length ? local : state_.epoch_length;
    for (Event event = next_event(); event.time <= limit; event = next_event()) perform(event);
    if (limit > state_.now) state_.now = limit;
    if (local < state_.epoch_length) return;
    pass_epoch(state_);
  }
}

Event Reference::next_event() const {
  const Box box(state_.box_length, state_.mixture);
  const std::vector<Disk>& disks = state_.disks;
  Event first{std::numeric_limits<double>::infinity(), EventKind::stop, no_disk, no_disk};
  auto consider = [&](const Event& event) {
    if (event < first) first = event;
  };
  for (std::uint32_t i = 0; i < disks.size(); ++i) {
    consider({disks[i].next_kick, EventKind::kick, i, no_disk});
    consider({transit_time(disks[i], box), EventKind::transit, i, no_disk});
    for (std::uint32_t j = i + 1; j < disks.size(); ++j) {
      const double contact = state_.mixture.radius[disks[i].species] + state_.mixture.radius[disks[j].species];
      consider({contact_time(disks[i], disks[j], contact, box), EventKind::contact, i, j});
    }
  }
  return first;
}

std::uint32_t Reference::partner_of(std::uint32_t i, double t, const Kick& kick) const {
  const Box box(state_.box_length, state_.mixture);
  const std::vector<Disk>& disks = state_.disks;
  std::vector<std::uint32_t> candidates;
  double best_gap = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < disks.size(); ++k) {
    if (k == i) continue;
    const double contact = state_.mixture.radius[disks[i].species] + state_.mixture.radius[disks[k].species];
    if (state_.drive.partner == PartnerRule::within) {
      if (within_reach(disks[i], disks[k], contact, state_.drive.reach, t, box)) candidates.push_back(k);
    } else if (const double gap = surface_gap(disks[i], disks[k], contact, t, box); gap < best_gap) {
      best_gap = gap;
      candidates.assign(1, k);
    }
  }
  return candidates.empty() ? no_disk : candidates[kick.pick(candidates.size())];
}

void Reference::perform(Event event) {
  const Box box(state_.box_length, state_.mixture);
  Tally& tally = state_.tally;
  const double t = event.time;
  auto mass = [&](const Disk& disk) { return state_.mixture.mass[disk.species]; };
  auto bring = [&](Disk& disk) { advance(disk, disk.image_x, disk.image_y, t, box); };
  Disk& a = state_.disks[event.first];

  if (event.kind == EventKind::contact) {
    Disk& b = state_.disks[event.second];
    bring(a);
    bring(b);
    const bool elastic = elastic_by_tc(state_.collision, t, a.last_contact, b.last_contact);
    const Impact impact =
        collide(a, b, PairMasses(mass(a), mass(b)), elastic ? 1.0 : state_.collision.restitution, box);
    a.last_contact = b.last_contact = t;
    ++tally.contacts[a.species + b.species];
    tally.elastic_contacts += elastic;
    tally.virial.add(impact.virial);
    tally.dissipated.add(impact.dissipated);
  } else if (event.kind == EventKind::kick) {
    const Kick kick = Kick::draw(state_.seed, event.first, ++a.kick_count);
    a.next_kick = t + kick.wait / clock_rate(state_.drive);
    const bool pair = state_.drive.kind == DriveKind::pair;
    if (pair) event.second = partner_of(event.first, t, kick);
    if (pair && event.second == no_disk) {
      ++tally.kicks_without_partner;
    } else {
      ++tally.kicks;
      const double px = state_.drive.amplitude * kick.px, py = state_.drive.amplitude * kick.py;
      bring(a);
      double gained = give_momentum(a, px, py, 1 / mass(a));
      ++tally.kicked[a.species];
      if (pair) {
        Disk& b = state_.disks[event.second];
        bring(b);
        gained += give_momentum(b, -px, -py, 1 / mass(b));
        ++tally.kicked[b.species];
      }
      tally.injected.add(gained);
    }
  } else {
    bring(a);
    ++tally.transits;
  }
  if (log_) log_->push_back(event);
}

std::string Reference::follow(const std::vector<Event>& events, std::uint64_t epoch, double now) {
  auto next_epoch = [this] {
    state_.now = state_.epoch_length;
    pass_epoch(state_);
  };
  for (const Event& event : events) {
    if (event.time < state_.now && state_.epoch < epoch) next_epoch();  // times are counted anew
    std::string wrong = objection(event);
    if (wrong.empty()) {
      state_.now = event.time;
      perform(event);
      continue;
    }
    return "at time " + std::to_string(static_cast<double>(state_.epoch) * state_.epoch_length + event.time) + " " +
           wrong;
  }
  while (state_.epoch < epoch) next_epoch();
  state_.now = now;
  return {};
}

/// What is wrong with an event as the next one; empty if nothing is.
std::string Reference::objection(const Event& event) const {
  const Box box(state_.box_length, state_.mixture);
  const std::vector<Disk>& disks = state_.disks;
  const bool pair = event.kind == EventKind::contact;
  auto named = [&](const std::string& what) {
    return what + " (disk " + std::to_string(event.first) +
           (event.second == no_disk ? ")" : " and disk " + std::to_string(event.second) + ")");
  };
  if (event.time < state_.now) return named("an event comes after a later one");
  if (event.first >= disks.size() || (pair && event.second >= disks.size())) return named("an event of no disk");
  const Disk& a = disks[event.first];
  auto contact_with = [&](const Disk& b) {
    return state_.mixture.radius[a.species] + state_.mixture.radius[b.species];
  };
  double due = 0;
  switch (event.kind) {
    case EventKind::contact:
      due = contact_time(a, disks[event.second], contact_with(disks[event.second]), box);
      break;
    case EventKind::kick:
      due = a.next_kick;
      break;
    default:
      due = transit_time(a, box);
  }
  if (due != event.time) return named("an event takes place at another time than the records say");
  if (event.kind == EventKind::kick && state_.drive.kind == DriveKind::pair) {
    const Kick kick = Kick::draw(state_.seed, event.first, a.kick_count + 1);
    if (partner_of(event.first, event.time, kick) != event.second) return named("a kick has the wrong partner");
  }
  for (std::uint32_t k = 0; k < disks.size(); ++k)
    if (k != event.first &&
        surface_gap(a, disks[k], contact_with(disks[k]), event.time, box) < -1e-9 * contact_with(disks[k]))
      return named("an event was missed: disk " + std::to_string(k) + " overlaps the first disk of an event");
  return {};
}

}  // namespace sandglass
