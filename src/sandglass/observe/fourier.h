// Discrete Fourier transforms whose bits are the same on every machine.
#pragma once

#include <cstddef>
#include <vector>

namespace sandglass {

/// Transforms each of the `width` columns of a `rows` x `width` array (row-major, real and imaginary parts apart) in
/// place: F[k] = sum_j f[j] exp(-2 pi i j k / rows). `rows` is a power of two. Neighbouring columns are done side by
/// side in vectors.
void transform_columns(std::vector<double>& real, std::vector<double>& imaginary, std::size_t rows, std::size_t width);

}  // namespace sandglass
