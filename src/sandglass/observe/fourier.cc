#include "sandglass/observe/fourier.h"

#include <algorithm>
#include <utility>

#include "sandglass/core/random.h"
#include "sandglass/observe/portable.h"

namespace sandglass {
namespace {

void reverse_bits(std::vector<double>& values, std::size_t rows, std::size_t width) {
  for (std::size_t row = 0, reversed = 0; row < rows; ++row) {
    if (row < reversed) std::swap_ranges(&values[row * width], &values[row * width] + width, &values[reversed * width]);
    std::size_t bit = rows / 2;
    for (; bit > 0 && (reversed & bit) != 0; bit /= 2) reversed ^= bit;
    reversed |= bit;
  }
}

// a, b <- a + w b, a - w b for two rows.
SANDGLASS_WIDE void combine(double* __restrict ar, double* __restrict ai, double* __restrict br, double* __restrict bi,
                            double wr, double wi, std::size_t width) {
  for (std::size_t c = 0; c < width; ++c) {
    const double re = wr * br[c] - wi * bi[c], im = wr * bi[c] + wi * br[c];
    br[c] = ar[c] - re;
    bi[c] = ai[c] - im;
    ar[c] += re;
    ai[c] += im;
  }
}

}  // namespace

void transform_columns(std::vector<double>& real, std::vector<double>& imaginary, std::size_t rows, std::size_t width) {
  reverse_bits(real, rows, width);
  reverse_bits(imaginary, rows, width);
  for (std::size_t half = 1; half < rows; half *= 2) {
    for (std::size_t k = 0; k < half; ++k) {
      const auto [sine, cosine] = portable_sincos_turns(static_cast<double>(k) / static_cast<double>(2 * half));
      for (std::size_t row = k; row < rows; row += 2 * half) {
        const std::size_t a = row * width, b = (row + half) * width;
        combine(&real[a], &imaginary[a], &real[b], &imaginary[b], cosine, -sine, width);
      }
    }
  }
}

}  // namespace sandglass
