// What an exact sum costs over a plain one. A collision adds two terms.
#include "sandglass/core/exact_sum.h"

#include <benchmark/benchmark.h>

#include <vector>

#include "sandglass/core/random.h"

namespace sandglass {
namespace {

constexpr std::size_t terms = 1024;  // in the fastest cache

std::vector<double> some_terms(double size) {
  std::vector<double> values(terms);
  for (std::size_t i = 0; i < terms; ++i) values[i] = size * (uniform(random_words(1, Stream::probe, i, 0)[0]) - 0.5);
  return values;
}

template <class Sum, class Add>
void add_terms(benchmark::State& state, double size, Sum sum, Add add) {
  const std::vector<double> values = some_terms(size);
  for (auto _ : state) {
    for (const double value : values) add(sum, value);
    benchmark::DoNotOptimize(sum);
  }
  state.counters["operation"] =
      benchmark::Counter(terms, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void exact(benchmark::State& state) {
  add_terms(state, 10, ExactSum{}, [](ExactSum& sum, double value) { sum.add(value); });
}
BENCHMARK(exact);

void exact_large_terms(benchmark::State& state) {  // beyond 128 each takes the slow path
  add_terms(state, 1e6, ExactSum{}, [](ExactSum& sum, double value) { sum.add(value); });
}
BENCHMARK(exact_large_terms);

void plain(benchmark::State& state) {
  add_terms(state, 10, 0.0, [](double& sum, double value) { sum += value; });
}
BENCHMARK(plain);

}  // namespace
}  // namespace sandglass
