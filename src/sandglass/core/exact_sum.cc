#include "sandglass/core/exact_sum.h"

#include "sandglass/core/errors.h"

namespace sandglass {

void ExactSum::add_large(double term) {
  if (!(std::fabs(term) < 0x1p82)) throw RunError("a sum received a value that is not a finite number of usable size");
  const double quanta = term / quantum;  // a power of two: exact
  // From 2^62 on a double is a whole number already.
  total_ += std::fabs(quanta) < 0x1p62 ? static_cast<Int128>(std::llrint(quanta)) : static_cast<Int128>(quanta);
}

}  // namespace sandglass
