// The oracle: the same dynamics in the most obvious way.
#pragma once

#include <string>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/drive.h"
#include "sandglass/dynamics/event.h"

namespace sandglass {

/// Looks at all pairs before every event: no lists, no cells, no calendar, no stored predictions. O(N^2) per event, for
/// tests only. Same interface and, event by event, the same trajectory as Simulation.
class Reference {
 public:
  explicit Reference(State state);

  void run_until(double end);

  /// Does the events that an engine says it has done, up to `now` in epoch `epoch`, if each is what the rules ask for
  /// at that time and nobody overlaps the disks concerned; returns what is wrong, or nothing. O(N) per event.
  [[nodiscard]] std::string follow(const std::vector<Event>& events, std::uint64_t epoch, double now);

  [[nodiscard]] double time() const { return state_.time(); }
  [[nodiscard]] const Tally& tally() const { return state_.tally; }
  [[nodiscard]] std::size_t size() const { return state_.size(); }
  [[nodiscard]] State state() const { return state_; }
  void make_frame(Frame& frame) const { sandglass::make_frame(state_, frame); }
  void set_event_log(std::vector<Event>* log) { log_ = log; }

 private:
  [[nodiscard]] Event next_event() const;
  [[nodiscard]] std::string objection(const Event& event) const;
  void perform(Event event);
  [[nodiscard]] std::uint32_t partner_of(std::uint32_t i, double t, const Kick& kick) const;

  State state_;
  std::vector<Event>* log_ = nullptr;
};

}  // namespace sandglass
