// A checksum over a whole file, kept in its first block, so that a damaged file is known before anything parses it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace sandglass {

/// Of a sequence of numbers. Two multiplications each, every step a bijection of the sum so far: no single change goes
/// unseen.
class Checksum {
 public:
  void add(std::uint64_t word) { sum_ = std::rotl((sum_ ^ (word * 0x9e3779b97f4a7c15u)) * 0xd6e8feb86659fd93u, 31); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::int64_t value) { add(static_cast<std::uint64_t>(value)); }
  void add(std::int32_t value) { add(std::int64_t{value}); }
  template <class T>
  void add_all(std::span<const T> values) {
    for (const T& value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

/// Bytes kept free at the start of a file for its seal (an HDF5 user block).
inline constexpr std::size_t seal_size = 512;

/// Fills the first block of `path` with the length and a 64-bit checksum of all that follows. Throws RunError.
void seal_file(const std::filesystem::path& path);

/// Whether the file starts as a sealed one does, right or wrong.
bool has_seal(const std::filesystem::path& path);

/// Throws InputError unless the file can be read, has a seal and the seal is right.
void check_seal(const std::filesystem::path& path);

}  // namespace sandglass
