// The self-check of a run: what must hold whatever the physics, looked at while it runs.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/reference.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/dynamics/vigilance.h"

namespace sandglass {

/// The run has gone wrong: a law that holds exactly is broken. The fault is in the machine or in the program.
struct Violation : RunError {
  using RunError::RunError;
};

/// Watches one Simulation. An inspection sees to it that no disk overlaps another by more than rounding, that nothing
/// foreseen was missed, that the neighbour lists are those of the disks in range, and that since the one before
///   change of kinetic energy = injected - dissipated,   change of momentum = 0 (but for single kicks)
/// up to the rounding of so many events.
class Watch {
 public:
  /// Beats between two inspections, one of which takes 0.1 us per disk, as long as the events of up to one beat.
  static constexpr std::uint64_t period = 128;

  explicit Watch(Vigilance vigilance = Vigilance::sampled) : vigilance_(vigilance) {}

  /// Around each beat.
  void before_beat(Simulation& simulation);
  void after_beat(Simulation& simulation);  ///< throws Violation

  /// Now, for example before a checkpoint is written. Throws Violation.
  void inspect(const Simulation& simulation);

 private:
  void compare_with_witness(const Simulation& simulation);

  Vigilance vigilance_;
  std::uint64_t beats_ = 0;
  bool inspected_ = false;
  Inspection last_{};  // the sums and the tally of the last inspection
  Tally tally_{};
  std::unique_ptr<Reference> witness_;
  std::vector<Event> events_;
};

}  // namespace sandglass
