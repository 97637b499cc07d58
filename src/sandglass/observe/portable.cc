#include "sandglass/observe/portable.h"

#include <limits>

namespace sandglass {

double portable_exp(double x) {
  if (!(x < 709.8)) return x > 0 ? std::numeric_limits<double>::infinity() : x;  // the latter: NaN
  if (x < -745.2) return 0;
  // x = n ln 2 + r with |r| <= ln(2)/2; the Taylor series of exp(r) is cut where r^15/15! < 1e-19.
  constexpr double ln2_high = 0x1.62e42fefa0000p-1;  // 40 bits, so that n * ln2_high is exact
  constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;
  constexpr double per_ln2 = 0x1.71547652b82fep+0;
  const double n = std::floor(x * per_ln2 + 0.5);
  const double r = (x - n * ln2_high) - n * ln2_low;
  double series = 1;
  for (int k = 14; k >= 1; --k) series = 1 + series * r / k;
  return std::ldexp(series, static_cast<int>(n));
}

}  // namespace sandglass
