// The functions behind random.h, without branches and calls, so that a loop over numbers is done several at a time.
// Built from + - * / alone, with the same bits however they are compiled.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace sandglass {

/// uniform of random.h.
[[gnu::always_inline]] inline double uniform_of(std::uint64_t word) {
  // The middle of a cell has 53 bits: exact. The upper 52 bits of the word become those of a number in [1, 2).
  return (std::bit_cast<double>(word >> 12 | 0x3ff0000000000000u) - 1) + 0x1p-53;
}

/// portable_log of random.h.
[[gnu::always_inline]] inline double log_of(double u) {
  // u = 2^e m with m in [1/sqrt 2, sqrt 2); ln m = 2 atanh(s), s = (m - 1)/(m + 1), |s| < 0.1716. The series in
  // s^2 < 0.0295 is cut after s^21: the next term is below 0.0295^11 / 23 < 1e-18 of the first.
  constexpr double ln2_high = 0x1.62e42fefa0000p-1;  // 40 bits, so that e * ln2_high is exact
  constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;
  // A subnormal u has no leading bit to read: scale it up, exactly.
  const bool subnormal = u < 0x1p-1022;
  const auto bits = std::bit_cast<std::uint64_t>(subnormal ? u * 0x1p54 : u);
  // These numbers are random, and a branch could not be foretold: whether to double m and lower e is 0 or 1.
  const std::uint64_t half = (bits & 0x000fffffffffffffu) | 0x3fe0000000000000u;  // in [1/2, 1)
  const std::uint64_t low = half < std::bit_cast<std::uint64_t>(0x1.6a09e667f3bcdp-1);
  const double m = std::bit_cast<double>(half + (low << 52));
  // The exponent as a double: 2^52 + k has k in its lowest bits.
  const double e =
      std::bit_cast<double>(((bits >> 52) - low) | 0x4330000000000000u) - (subnormal ? 0x1p52 + 1076 : 0x1p52 + 1022);
  const double f = m - 1;
  const double s = f / (m + 1);
  const double s2 = s * s;
  double series = 1.0 / 21;
#pragma GCC unroll 16
  for (int k = 19; k >= 3; k -= 2) series = series * s2 + 1.0 / k;
  series *= s2;
  return e * ln2_high + (2 * s + (2 * s * series + e * ln2_low));
}

struct SineCosine {
  double sine, cosine;
};

/// portable_sincos_turns of random.h.
[[gnu::always_inline]] inline SineCosine sincos_of_turns(double turns) {
  // Nearest quarter turn out, exactly; what is left, |r| <= 1/8 turn, goes into Taylor series cut where the next term
  // is below 1e-18 ((pi/4)^19/19! = 8e-20, (pi/4)^18/18! = 2e-18).
  constexpr double to_integer = 0x1.8p52;  // adding it rounds, and leaves the whole number in the lowest bits
  const double shifted = turns * 4 + to_integer;
  const double quarters = shifted - to_integer;
  const double r = (turns - quarters * 0.25) * 0x1.921fb54442d18p+2;
  const double r2 = r * r;
  constexpr double inverse_factorial[18] = {1.0,
                                            1.0,
                                            1.0 / 2,
                                            1.0 / 6,
                                            1.0 / 24,
                                            1.0 / 120,
                                            1.0 / 720,
                                            1.0 / 5040,
                                            1.0 / 40320,
                                            1.0 / 362880,
                                            1.0 / 3628800,
                                            1.0 / 39916800,
                                            1.0 / 479001600,
                                            1.0 / 6227020800,
                                            1.0 / 87178291200,
                                            1.0 / 1307674368000,
                                            1.0 / 20922789888000,
                                            1.0 / 355687428096000};
  double sine = inverse_factorial[17], cosine = inverse_factorial[16];
#pragma GCC unroll 16
  for (int k = 15; k >= 3; k -= 2) sine = inverse_factorial[k] - r2 * sine;
#pragma GCC unroll 16
  for (int k = 14; k >= 2; k -= 2) cosine = inverse_factorial[k] - r2 * cosine;
  sine = r - r * r2 * sine;
  cosine = 1 - r2 * cosine;
  // Quarter turns: 0 (s, c), 1 (c, -s), 2 (-s, -c), 3 (-c, s).
  const auto quarter = std::bit_cast<std::uint64_t>(shifted);
  const std::uint64_t swap =
      (std::bit_cast<std::uint64_t>(sine) ^ std::bit_cast<std::uint64_t>(cosine)) & (0 - (quarter & 1));
  auto signed_by = [&](double value, std::uint64_t sign) {  // by the second bit of `sign`
    return std::bit_cast<double>((std::bit_cast<std::uint64_t>(value) ^ swap) ^ (sign & 2) << 62);
  };
  return {signed_by(sine, quarter), signed_by(cosine, quarter + 1)};
}

}  // namespace sandglass
