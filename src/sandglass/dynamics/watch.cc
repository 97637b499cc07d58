#include "sandglass/dynamics/watch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace sandglass {
namespace {

std::uint64_t events(const Tally& tally) { return tally.collisions() + tally.kicks; }

/// What rounding may add to an energy, or to a component of the momentum, in so many events, at the very worst: each is
/// recorded to half a quantum, and changes velocities to some roundings of 2^-53 of the greatest energy that a disk may
/// plausibly have, 64 times the mean. The sums over all disks add a quantum each. (Errors that add up as a random walk
/// stay some 10^4 times smaller; a bit that flips in the upper half of a velocity is larger.)
double allowance(double events, double disks, double energy) {
  return (events + disks) * (ExactSum::quantum + 0x1p-49 * 64 * (energy / disks));
}

}  // namespace

std::string describe(const Inspection& inspection) {
  static constexpr std::array what{"nothing is wrong",
                                   "a coordinate or velocity is not a number",
                                   "a centre is outside the box",
                                   "the radius is not that of the species",
                                   "a record comes from the future",
                                   "a disk has flown on beyond where its record must be advanced",
                                   "an event was missed",
                                   "a foreseen contact is not foreseen by the partner",
                                   "a disk has left the range of its neighbour list",
                                   "a neighbour list is not that of the disks in range",
                                   "two disks overlap"};
  std::string text = what.at(static_cast<std::size_t>(inspection.fault));
  if (inspection.first != no_disk) text += " (disk " + std::to_string(inspection.first);
  if (inspection.second != no_disk) text += " and disk " + std::to_string(inspection.second);
  return inspection.first == no_disk ? text : text + ")";
}

void Watch::before_beat(Simulation& simulation) {
  if (!inspected_) inspect(simulation);  // the sums that the first beats are held against
  if (vigilance_ != Vigilance::every_event) return;
  if (!witness_) witness_ = std::make_unique<Reference>(simulation.state());
  events_.clear();
  simulation.set_event_log(&events_);
}

void Watch::after_beat(Simulation& simulation) {
  if (vigilance_ == Vigilance::every_event) {
    compare_with_witness(simulation);
    inspect(simulation);
  } else if (++beats_ % period == 0) {
    inspect(simulation);
  }
}

void Watch::inspect(const Simulation& simulation) {
  const Inspection now = simulation.inspect();
  auto violation = [&](const std::string& what) {
    return Violation("at time " + std::to_string(simulation.time()) + " " + what);
  };
  if (now.fault != Fault::none) throw violation(describe(now));
  const Tally& tally = simulation.tally();
  if (inspected_) {
    auto difference = [](ExactSum sum, const ExactSum& before) {
      sum.subtract(before);
      return sum;
    };
    ExactSum energy = difference(now.energy, last_.energy);
    energy.subtract(difference(tally.injected, tally_.injected));
    energy.add(difference(tally.dissipated, tally_.dissipated));
    const auto done = static_cast<double>(events(tally) - events(tally_));
    const double most = std::fmax(now.energy.value(), last_.energy.value());
    const double allowed = allowance(done, static_cast<double>(simulation.size()), most);
    if (!(std::fabs(energy.value()) <= allowed))
      throw violation("the energy balance is broken: kinetic energy has changed by " + std::to_string(energy.value()) +
                      " beyond what was injected and dissipated");
    const double drift = std::fmax(std::fabs(difference(now.momentum_x, last_.momentum_x).value()),
                                   std::fabs(difference(now.momentum_y, last_.momentum_y).value()));
    if (simulation.conserves_momentum() && !(drift <= allowed))
      throw violation("the total momentum has changed by " + std::to_string(drift));
  }
  inspected_ = true;
  last_ = now;
  tally_ = tally;
}

void Watch::compare_with_witness(const Simulation& simulation) {
  State state = simulation.state();
  const std::string wrong = witness_->follow(events_, state.epoch, state.now);
  if (!wrong.empty()) throw Violation(wrong);
  state = simulation.state();  // following takes most of the time: what is compared is what a checkpoint would hold now
  if (state_hash(state) != state_hash(witness_->state()))
    throw Violation("at time " + std::to_string(state.time()) +
                    " the records differ from those that the same events leave by the rule");
}

}  // namespace sandglass
