#include "sandglass/core/random.h"

#include <Random123/philox.h>

#include <bit>
#include <cmath>

namespace sandglass {
namespace {

constexpr auto inverse_factorial = [] {
  std::array<double, 18> values{1};
  double factorial = 1;  // exact in a double up to 18!
  for (int k = 1; k < 18; ++k) values[static_cast<std::size_t>(k)] = 1 / (factorial *= k);
  return values;
}();

}  // namespace

std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t id, std::uint64_t count) {
  const r123::Philox4x64::ctr_type counter{{id, count, 0, 0}};
  const r123::Philox4x64::key_type key{{seed, static_cast<std::uint64_t>(stream)}};
  const auto words = r123::Philox4x64{}(counter, key);
  return {words[0], words[1], words[2], words[3]};
}

double uniform(std::uint64_t word) {
  // 52 bits, so that k + 1/2 is exact and never rounds up to 1.
  return (static_cast<double>(word >> 12) + 0.5) * 0x1p-52;
}

double exponential(std::uint64_t word) { return -portable_log(uniform(word)); }

std::array<double, 2> gaussian_pair(std::uint64_t word1, std::uint64_t word2) {
  const double radius = std::sqrt(2 * exponential(word1));
  const auto [sine, cosine] = portable_sincos_turns(uniform(word2));
  return {radius * cosine, radius * sine};
}

double portable_log(double u) {
  // u = 2^e m with m in [1/sqrt 2, sqrt 2); ln m = 2 atanh(s), s = (m - 1)/(m + 1), |s| < 0.1716. The series in
  // s^2 < 0.0295 is cut after s^21: the next term is below 0.0295^11 / 23 < 1e-18 of the first.
  constexpr double ln2_high = 0x1.62e42fefa0000p-1;  // 40 bits, so that e * ln2_high is exact
  constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;
  // A subnormal u has no leading bit to read: scale it up, exactly.
  const bool subnormal = u < 0x1p-1022;
  const auto bits = std::bit_cast<std::uint64_t>(subnormal ? u * 0x1p54 : u);
  int exponent = static_cast<int>(bits >> 52) - 1022 - (subnormal ? 54 : 0);
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffu) | 0x3fe0000000000000u);  // in [1/2, 1)
  const bool low = m < 0x1.6a09e667f3bcdp-1;  // no branches: these numbers are random
  constexpr double factor[2] = {1, 2};
  m *= factor[low];
  exponent -= low;
  const double f = m - 1;
  const double s = f / (m + 1);
  const double s2 = s * s;
  double series = 1.0 / 21;
  for (int k = 19; k >= 3; k -= 2) series = series * s2 + 1.0 / k;
  series *= s2;
  const double e = exponent;
  return e * ln2_high + (2 * s + (2 * s * series + e * ln2_low));
}

std::array<double, 2> portable_sincos_turns(double turns) {
  // Nearest quarter turn out, exactly; what is left, |r| <= 1/8 turn, goes into Taylor series cut where the next term
  // is below 1e-18 ((pi/4)^19/19! = 8e-20, (pi/4)^18/18! = 2e-18).
  const double quarters = std::nearbyint(turns * 4);
  const double r = (turns - quarters * 0.25) * 0x1.921fb54442d18p+2;
  const double r2 = r * r;
  double sine = inverse_factorial[17], cosine = inverse_factorial[16];
  for (int k = 15; k >= 3; k -= 2) sine = inverse_factorial[static_cast<std::size_t>(k)] - r2 * sine;
  for (int k = 14; k >= 2; k -= 2) cosine = inverse_factorial[static_cast<std::size_t>(k)] - r2 * cosine;
  sine = r - r * r2 * sine;
  cosine = 1 - r2 * cosine;
  const double values[2] = {sine, cosine};
  constexpr double sine_sign[4] = {1, 1, -1, -1}, cosine_sign[4] = {1, -1, -1, 1};
  const auto quarter = static_cast<std::uint64_t>(static_cast<std::int64_t>(quarters)) & 3;
  return {sine_sign[quarter] * values[quarter & 1], cosine_sign[quarter] * values[~quarter & 1]};
}

}  // namespace sandglass
