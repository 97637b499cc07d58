// The engine as Simulation sees it: one implementation (engine.cc), compiled once per instruction set.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/state.h"
#include "sandglass/dynamics/crew.h"
#include "sandglass/dynamics/event.h"
#include "sandglass/dynamics/inspection.h"
#include "sandglass/dynamics/simulation.h"

namespace sandglass {

/// Two disks that overlap by more than rounding when a state is loaded.
struct OverlappingPair {
  std::uint32_t first = no_disk, second = no_disk;
  double depth = 0;
};

/// Works on one epoch of a run. The State belongs to the caller: between load and store the engine holds the records
/// (by slot, in spatial order), the State everything else, including the tally that the engine adds to.
class Engine {
 public:
  virtual ~Engine();

  /// Takes the records from state.disks, which it frees, and makes lists, predictions and calendar at state.now.
  /// `order[slot]` is the id that goes into a slot. Returns the deepest overlap beyond rounding, if any.
  virtual OverlappingPair load(const std::uint32_t* order) = 0;

  /// Frees lists and calendar, most of the memory; only to store can follow.
  virtual void forget_what_comes() = 0;

  /// Writes the records by id.
  virtual void store(Disk* disks) const = 0;

  /// Does every event at or before `end`, a time within the epoch, and sets state.now to it.
  virtual void run(double end) = 0;

  /// Looks for what cannot be between two events. Changes nothing.
  virtual Inspection inspect() = 0;

  /// How many threads it uses, once loaded.
  [[nodiscard]] virtual unsigned threads() const = 0;

  virtual void make_frame(double* x, double* y, double* vx, double* vy) const = 0;

  std::vector<Event>* log = nullptr;
  Crew* crew = nullptr;  ///< where several threads may be used
  Simulation::Bookkeeping bookkeeping;

 protected:
  /// The log of one of several strips, if there is a log; and all of them, in canonical order, into the log.
  std::vector<Event>* strip_log(std::size_t strip);
  void gather_strip_logs();
  void drop_strip_logs();

 private:
  std::vector<std::vector<Event>> strip_logs_;
};

/// One per instruction set; all give the same bits. `state` must outlive the engine.
Engine* make_engine_baseline(State& state, const Tuning& tuning);
Engine* make_engine_avx2(State& state, const Tuning& tuning);
Engine* make_engine_avx512(State& state, const Tuning& tuning);

// Outside the engine, so that no library template is compiled for more than the baseline instruction set.
void append_event(std::vector<Event>& log, const Event& event);
struct DiskName {
  std::uint32_t id, slot;
};
DiskName nth_by_id(DiskName* first, DiskName* last, std::size_t n);  ///< the n-th (from 0) in the order of ids
[[noreturn]] void report_collapse(const State& state, double t);     ///< throws RunError

}  // namespace sandglass
