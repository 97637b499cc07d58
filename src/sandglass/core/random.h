// Random numbers as pure functions: Philox4x64-10 of (seed, stream; disk id, count). No generator has hidden state,
// so a number depends neither on the order of events nor on threads.
#pragma once

#include <array>
#include <cstdint>

namespace sandglass {

/// Named random streams; one per purpose, never shared.
enum class Stream : std::uint64_t { positions = 1, velocities = 2, kicks = 3, probe = 4 };

/// Four independent 64-bit words. [Salmon et al., SC11 (2011)]
std::array<std::uint64_t, 4> random_words(std::uint64_t seed, Stream stream, std::uint64_t id, std::uint64_t count);

/// Uniform in (0, 1): the middle of one of 2^52 equal cells; never 0 or 1.
double uniform(std::uint64_t word);

/// Exponential with mean 1: -ln u.
double exponential(std::uint64_t word);

/// Two independent standard normal variates (Box-Muller).
std::array<double, 2> gaussian_pair(std::uint64_t word1, std::uint64_t word2);

/// Natural logarithm and sine/cosine of 2 pi u built from + - * / alone, so that their bits are the same on every
/// machine (a C library's are not). Relative error of the logarithm below 4 ulp for finite u > 0; absolute error of
/// sine and cosine below 4e-16 for |turns| < 2^40.
double portable_log(double u);
std::array<double, 2> portable_sincos_turns(double turns);  ///< {sin, cos} of 2 pi turns

}  // namespace sandglass
