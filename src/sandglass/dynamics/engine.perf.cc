// The micro-benchmarks of the engine, for every instruction set that this machine has. What runs is in the other
// *.perf.cc, compiled once per instruction set; what it runs on is made here, so that no library template is compiled
// for more than the baseline.
#include "sandglass/dynamics/engine.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "sandglass/core/random.h"
#include "sandglass/dynamics/random_state.test.h"
#include "sandglass/dynamics/spatial_order.h"

namespace sandglass {

#define SANDGLASS_OPERATIONS(isa)                                                          \
  inline namespace isa {                                                                   \
  void pop_and_push(benchmark::State& state, const double* leads, std::size_t size);       \
  void renew(benchmark::State& state, const State& here, const State& there, double skin); \
  void search(benchmark::State& state, Engine& engine);                                    \
  }
SANDGLASS_OPERATIONS(baseline)
SANDGLASS_OPERATIONS(avx2)
SANDGLASS_OPERATIONS(avx512)

namespace {

/// An undriven fluid of 10^4 disks at packing fraction 0.5, all records at the same time, neighbours near in memory.
State make_fluid() {
  RandomSystem system;
  system.particles = 10000;
  system.packing_fraction = 0.5;
  system.restitution = 1;
  Simulation simulation(random_state(system));
  simulation.run_until(system.epoch_length);
  State state = std::move(simulation).state();
  std::vector<Disk> disks;
  for (const std::uint32_t id : spatial_order(state)) disks.push_back(state.disks[id]);
  state.disks = std::move(disks);
  return state;
}

const State& fluid() {
  static const State made = make_fluid();
  return made;
}

/// Width of the lists for about eight neighbours, as in the engine.
double skin_of(const State& state) {
  const double area_per_disk = state.box_length * state.box_length / static_cast<double>(state.size());
  return std::sqrt(8 * area_per_disk / 3.14159) - state.mixture.radius[small] - state.mixture.radius[big];
}

/// Every disk moved by `distance` in a direction of its own.
State scattered(State state, double distance) {
  for (std::size_t i = 0; i < state.size(); ++i) {
    const double angle = 2 * 3.14159 * uniform(random_words(1, Stream::probe, i, 1)[0]);
    state.disks[i].x += distance * std::cos(angle);
    state.disks[i].y += distance * std::sin(angle);
  }
  return state;
}

std::vector<double> exponential_leads(std::size_t size) {
  std::vector<double> leads(size);
  for (std::size_t i = 0; i < size; ++i) leads[i] = exponential(random_words(1, Stream::probe, i, 2)[0]);
  return leads;
}

struct InstructionSet {
  std::string name;
  Engine* (*make_engine)(State&, const Tuning&);
  decltype(&baseline::pop_and_push) pop_and_push;
  decltype(&baseline::renew) renew;
  decltype(&baseline::search) search;
};

template <class Operation>
void add(const std::string& name, Operation operation) {
  benchmark::RegisterBenchmark(name.c_str(), [operation](benchmark::State& state) {
    operation(state);
    const auto per_operation = benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert;
    state.counters["operation"] = benchmark::Counter(1, per_operation);
  });
}

void add_all(const InstructionSet& set) {
  for (const std::size_t size : {10000, 1000000})
    add(set.name + "/pop_and_push/" + std::to_string(size), [set, size](benchmark::State& state) {
      const std::vector<double> leads = exponential_leads(size);
      set.pop_and_push(state, leads.data(), size);
    });
  add(set.name + "/renew", [set](benchmark::State& state) {
    const State& here = fluid();
    const double skin = skin_of(here);
    set.renew(state, here, scattered(here, skin / 2), skin);
  });
  add(set.name + "/search", [set](benchmark::State& state) {
    State loaded = fluid();
    const std::unique_ptr<Engine> engine(set.make_engine(loaded, {}));
    engine->load(spatial_order(loaded).data());
    set.search(state, *engine);
  });
  add(set.name + "/inspect_10000", [set](benchmark::State& state) {
    State loaded = fluid();
    const std::unique_ptr<Engine> engine(set.make_engine(loaded, {}));
    engine->load(spatial_order(loaded).data());
    for (auto iteration : state) benchmark::DoNotOptimize(engine->inspect());
  });
}

[[maybe_unused]] const bool added = [] {
#ifdef SANDGLASS_X86_64
  __builtin_cpu_init();
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  if (has_avx512) add_all({"avx512", make_engine_avx512, avx512::pop_and_push, avx512::renew, avx512::search});
  if (has_avx2) add_all({"avx2", make_engine_avx2, avx2::pop_and_push, avx2::renew, avx2::search});
#endif
  add_all({"baseline", make_engine_baseline, baseline::pop_and_push, baseline::renew, baseline::search});
  return true;
}();

}  // namespace
}  // namespace sandglass
