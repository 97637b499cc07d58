#include "sandglass/core/random.h"

#include <Random123/philox.h>

#include <cmath>

#include "sandglass/core/portable_functions.h"

namespace sandglass {

std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t id, std::uint64_t count) {
  const r123::Philox4x64::ctr_type counter{{id, count, 0, 0}};
  const r123::Philox4x64::key_type key{{seed, static_cast<std::uint64_t>(stream)}};
  const auto words = r123::Philox4x64{}(counter, key);
  return {words[0], words[1], words[2], words[3]};
}

double uniform(std::uint64_t word) { return uniform_of(word); }

double exponential(std::uint64_t word) { return -portable_log(uniform(word)); }

std::array<double, 2> gaussian_pair(std::uint64_t word1, std::uint64_t word2) {
  const double radius = std::sqrt(2 * exponential(word1));
  const auto [sine, cosine] = sincos_of_turns(uniform(word2));
  return {radius * cosine, radius * sine};
}

double portable_log(double u) { return log_of(u); }

std::array<double, 2> portable_sincos_turns(double turns) {
  const auto [sine, cosine] = sincos_of_turns(turns);
  return {sine, cosine};
}

}  // namespace sandglass
