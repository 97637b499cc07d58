// What it costs to search the list of one disk for its earliest contact.
#include <benchmark/benchmark.h>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

struct PredictionPerf {
  /// Nothing comes next for disk i and its partner, as when they have just collided. (A contact that stands in both
  /// records already would be found twice, and that is a rare case of its own.)
  static void forget_contact(IsaEngine& engine, std::uint32_t i) {
    Record& disk = engine.tables_.records[i];
    if (disk.partner != no_disk) set_next(engine.tables_.records[disk.partner], never, Next::review, no_disk);
    set_next(disk, never, Next::review, no_disk);
  }

  static void search(benchmark::State& state, IsaEngine& engine) {
    const auto size = static_cast<std::uint32_t>(engine.tables_.size);
    for (std::uint32_t i = 0; i < size; i += searched) forget_contact(engine, i);
    std::uint32_t i = 0;
    for (auto _ : state) {
      benchmark::DoNotOptimize(engine.whole_.earliest_contact(i).time);
      i += searched;
      if (i >= size) i = 0;
    }
  }

  static constexpr std::uint32_t searched = 4;  // every fourth disk: most of its neighbours have something next
};

/// In a loaded engine, in the order of memory: the records are in the cache, as fetching ahead has them in a run.
void search(benchmark::State& state, Engine& engine) { PredictionPerf::search(state, static_cast<IsaEngine&>(engine)); }

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
