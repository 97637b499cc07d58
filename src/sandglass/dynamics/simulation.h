// The exact event-driven engine.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sandglass/core/frame.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/event.h"
#include "sandglass/dynamics/inspection.h"

namespace sandglass {

/// Free choices of the engine. None of them changes a bit of the result; 0 means "let the program choose".
struct Tuning {
  double skin = 0;                    ///< width of the neighbour lists beyond contact, in R_s
  double cell_size = 0;               ///< least side of a cell of the look-up grid, in R_s
  double window_events = 0;           ///< events in a window of the calendar
  std::size_t most_in_cache = 20000;  ///< disks whose records are taken to fit into the cache
  /// Whether one thread works out several events at a time (batch.cc); never where records do not fit into the cache.
  enum class Batches : std::uint8_t { where_faster, never, always } batches = Batches::where_faster;
  unsigned threads = 1;  ///< at most; fewer where the box is too small for as many strips
  // For tests of what several threads do:
  std::uint32_t strip_rows = 0;  ///< least height of a strip, in rows of the grid
  double window_part = 0;        ///< how far the fastest disk may fly in a window, in skins
  double freezing_depth = 0;     ///< how far from the lanes between strips disks are thought to be frozen, in R_s
  double top_speed = 0;          ///< speed that a disk is trusted not to exceed, in thermal speeds sqrt(T/m)
};

/// With fewer disks one thread is faster than several: a window has too little work for its borders (docs/parallel.md).
inline constexpr std::size_t least_disks_for_threads = 50000;

/// Of the threads asked for, how many to use for a trajectory of so many disks.
inline unsigned threads_for(std::size_t particles, std::uint64_t asked) {
  return particles < least_disks_for_threads ? 1 : static_cast<unsigned>(asked);
}

/// Event-driven dynamics of a State. Neighbour lists find who may meet, a calendar finds who meets next.
/// Throws InputError for a state that cannot be run exactly (overlap, box too small, disk outside the box, NaN).
class Simulation {
 public:
  explicit Simulation(State state, const Tuning& tuning = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Does every event at or before physical time `end` (since the start of the run, not the epoch).
  void run_until(double end);

  [[nodiscard]] double time() const;
  [[nodiscard]] const Tally& tally() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool conserves_momentum() const;  ///< single kicks do not
  [[nodiscard]] unsigned threads() const;         ///< that are used, at most tuning.threads

  /// A copy of the run at this moment; a new Simulation made from it goes on with the same bits. A Simulation that is
  /// no longer needed (std::move) frees its tables first.
  [[nodiscard]] State state() const&;
  [[nodiscard]] State state() &&;
  void make_frame(Frame& frame) const;

  /// What can be seen to be wrong with the engine's tables, and sums over the records, at this moment. O(N).
  [[nodiscard]] Inspection inspect() const;

  /// From now on appends every physical event to `log` (for tests; nullptr stops it).
  void set_event_log(std::vector<Event>* log);

  /// The instruction set that the engine uses on this machine: baseline, avx2 or avx512. All give the same bits.
  static const char* instruction_set();

  /// Work that is bookkeeping, not physics: how the engine's time was spent.
  struct Bookkeeping {
    std::uint64_t predictions = 0, orphans = 0, list_rebuilds = 0, wide_partner_searches = 0;
    // Where several threads work: windows; disks frozen in them, by passes, those resumed in the last one alone;
    // windows that were done again: a frozen disk was faster than trusted, might kick too far, or stood too far from
    // the lanes; or a list was full.
    std::uint64_t windows = 0, frozen = 0, left_over = 0, windows_undone = 0;
  };
  [[nodiscard]] Bookkeeping bookkeeping() const;

 private:
  struct Run;
  std::unique_ptr<Run> run_;
};

}  // namespace sandglass
