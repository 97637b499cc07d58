// The bins of the self van Hove function, the distribution of displacements.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace sandglass {

/// Bins of the distance r, eight per factor of two (r^2 is cut where its leading three bits change, which takes no
/// logarithm): the first from 0 to 2^-10 2^(1/8) or so, the last up to 2^8, in R_s. One more counts all that is beyond.
inline constexpr std::size_t van_hove_bins = 144;

inline constexpr std::uint64_t van_hove_first = std::bit_cast<std::uint64_t>(0x1p-20) >> 50;

inline std::size_t van_hove_bin(double square) {
  const std::uint64_t place = std::bit_cast<std::uint64_t>(square) >> 50;
  return std::min<std::size_t>(place > van_hove_first ? place - van_hove_first : 0, van_hove_bins);
}

/// r^2 at the inner edge of a bin (0 for the first), up to that of `van_hove_bins`, the end.
inline double van_hove_edge_squared(std::size_t bin) {
  return bin == 0 ? 0 : std::bit_cast<double>((van_hove_first + bin) << 50);
}

}  // namespace sandglass
