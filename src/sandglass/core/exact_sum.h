// A sum of doubles whose value does not depend on the order of its terms.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace sandglass {

/// Fixed-point accumulator: every term is rounded once to a multiple of the quantum 2^-44 (5.7e-14), after which
/// addition is that of 128-bit integers: exact, associative, commutative. Threads, chunks and resumed runs therefore
/// give the same bits. Terms below 128 in magnitude take the fast path; a term or the sum may reach 2^82 (5e24).
class ExactSum {
 public:
  static constexpr double quantum = 0x1p-44;

  [[gnu::always_inline]] void add(double term) {
    // Adding 1.5 * 2^52 quanta makes the addition itself round to a whole number of quanta, which then stands in
    // the low mantissa bits: no conversion instruction, the same bits on every machine.
    constexpr double shift = 0x1.8p52 * quantum;
    if (std::fabs(term) < 0x1p51 * quantum) [[likely]] {
      const auto biased = std::bit_cast<std::int64_t>(term + shift);
      total_ += biased - std::bit_cast<std::int64_t>(shift);
    } else {
      add_large(term);
    }
  }

  /// Adds eight terms.
  [[gnu::always_inline]] void add(const double (&terms)[8]) {
    constexpr double shift = 0x1.8p52 * quantum;
    std::uint64_t sum = 0;  // of eight differences below 2^52; where they are larger it is not used
    bool all_small = true;
    for (const double term : terms) {
      sum += std::bit_cast<std::uint64_t>(term + shift) - std::bit_cast<std::uint64_t>(shift);
      all_small &= std::fabs(term) < 0x1p51 * quantum;
    }
    if (all_small) [[likely]] {
      total_ += static_cast<std::int64_t>(sum);
    } else {
      for (const double term : terms) add(term);
    }
  }

  void add(const ExactSum& other) { total_ += other.total_; }
  void subtract(const ExactSum& other) { total_ -= other.total_; }

  /// The sum rounded to the nearest double.
  [[nodiscard]] double value() const { return static_cast<double>(total_) * quantum; }

  friend bool operator==(const ExactSum&, const ExactSum&) = default;

  /// The two halves of the integer, for checkpoints.
  [[nodiscard]] std::int64_t high() const { return static_cast<std::int64_t>(total_ >> 64); }
  [[nodiscard]] std::uint64_t low() const { return static_cast<std::uint64_t>(total_); }
  static ExactSum from_halves(std::int64_t high, std::uint64_t low) {
    ExactSum sum;
    sum.total_ = (static_cast<Int128>(high) << 64) | low;  // C++20: a left shift of a negative is defined
    return sum;
  }

 private:
  __extension__ using Int128 = __int128;
  void add_large(double term);  // throws RunError for a NaN or a term beyond 2^82

  Int128 total_ = 0;
};

}  // namespace sandglass
