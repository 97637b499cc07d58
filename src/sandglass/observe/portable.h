// Elementary functions whose bits are the same on every machine, for results that are computed on line.
#pragma once

#include <cmath>

/// Before a function that works on a loop over disks: it is compiled for three widths of vectors, and the widest that
/// the machine has is taken. The operations are the same, on more disks at a time, and none is a fused multiply-add:
/// the same bits.
#ifdef __x86_64__
#define SANDGLASS_WIDE [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define SANDGLASS_WIDE
#endif

namespace sandglass {

/// cos(2 pi u) for |u| < 2^50, absolute error below 1e-13 (and that of u itself, 2 pi |u| 1.1e-16). Built from + - *
/// and the sign bit alone, without branches, so that a loop over disks is done several disks at a time.
[[gnu::always_inline]] inline double cosine_of_turns(double u) {
  // Adding 1.5 * 2^52 rounds to a whole number of turns; what is left has |r| <= 1/2, and
  // cos(2 pi r) = sin(2 pi t) with t = 1/4 - |r| in [-1/4, 1/4].
  constexpr double to_integer = 0x1.8p52;
  const double r = u - ((u + to_integer) - to_integer);
  const double t = 0.25 - std::fabs(r);
  // Odd polynomial of degree 13 that interpolates sin(2 pi t) / t at the Chebyshev points of t^2 in [0, 1/16]; its
  // largest error in the interval is 7.8e-14.
  const double z = t * t;
  double p = 0x1.d53abdeb199c1p+1;
  p = p * z - 0x1.e29b82ab98ea9p+3;
  p = p * z + 0x1.50770f6a5a66bp+5;
  p = p * z - 0x1.32d2c9b2d1df5p+6;
  p = p * z + 0x1.466bc66ed3d1cp+6;
  p = p * z - 0x1.4abbce624ad99p+5;
  p = p * z + 0x1.921fb54442bb4p+2;
  return p * t;
}

/// exp(x), relative error below 4e-16 for |x| < 700; 0 below -745, infinity above 709.8.
double portable_exp(double x);

}  // namespace sandglass
