// What it costs to take the earliest event out of the calendar and to enter another.
#include "sandglass/dynamics/calendar.h"

#include <benchmark/benchmark.h>

#include <cmath>

#include "sandglass/dynamics/simulation.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// As many entries as there are leads (how far ahead an event lies; mean 1), which are used over and over.
void pop_and_push(benchmark::State& state, const double* leads, std::size_t size) {
  Array<Record> records(size);
  const double window = 2 / std::sqrt(static_cast<double>(size));  // as long as in the engine
  Calendar calendar(0, 1, window, size, size > Tuning().most_in_cache);
  std::size_t drawn = 0;
  auto enter = [&](std::uint32_t slot, double now) {
    records[slot].next_time = now + leads[drawn];
    calendar.push(records[slot].next_time, slot);
    if (++drawn == size) drawn = 0;
  };
  auto in_order = [](std::uint32_t a, std::uint32_t b) { return a < b; };
  auto next = [&] {
    const std::uint32_t slot = calendar.pop(&records[0], std::numeric_limits<double>::infinity(), in_order);
    prefetch(&records[calendar.coming(8).slot]);  // the engine has more to fetch
    enter(slot, records[slot].next_time);
  };
  for (std::uint32_t slot = 0; slot < size; ++slot) enter(slot, 0);
  for (std::size_t i = 0; i < size; ++i) next();  // until the slots are in no order
  for (auto _ : state) next();
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
