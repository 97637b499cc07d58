// What the random numbers of a kick cost.
#include "sandglass/core/random.h"

#include <benchmark/benchmark.h>

namespace sandglass {
namespace {

const auto per_operation = benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert;

void words(benchmark::State& state) {
  std::uint64_t count = 0;
  for (auto _ : state) benchmark::DoNotOptimize(random_words(1, Stream::kicks, 7, ++count));
  state.counters["operation"] = benchmark::Counter(1, per_operation);
}
BENCHMARK(words);

void exponential_variate(benchmark::State& state) {
  std::uint64_t word = 0;
  for (auto _ : state) benchmark::DoNotOptimize(exponential(word += 0x9e3779b97f4a7c15u));  // all of [0, 2^64)
  state.counters["operation"] = benchmark::Counter(1, per_operation);
}
BENCHMARK(exponential_variate);

void gaussian_variates(benchmark::State& state) {
  std::uint64_t word = 0;
  for (auto _ : state) {
    word += 0x9e3779b97f4a7c15u;
    benchmark::DoNotOptimize(gaussian_pair(word, ~word));
  }
  state.counters["operation"] = benchmark::Counter(1, per_operation);
}
BENCHMARK(gaussian_variates);

void whole_kick(benchmark::State& state) {
  std::uint64_t count = 0;
  for (auto _ : state) {
    const auto drawn = random_words(1, Stream::kicks, 7, ++count);
    benchmark::DoNotOptimize(exponential(drawn[0]));
    benchmark::DoNotOptimize(gaussian_pair(drawn[1], drawn[2]));
  }
  state.counters["operation"] = benchmark::Counter(1, per_operation);
}
BENCHMARK(whole_kick);

}  // namespace
}  // namespace sandglass
