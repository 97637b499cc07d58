// A checksum over a whole file, kept in its first block, so that a damaged file is known before anything parses it.
#pragma once

#include <cstddef>
#include <filesystem>

namespace sandglass {

/// Bytes kept free at the start of a file for its seal (an HDF5 user block).
inline constexpr std::size_t seal_size = 512;

/// Fills the first block of `path` with the length and a 64-bit checksum of all that follows. Throws RunError.
void seal_file(const std::filesystem::path& path);

/// Whether the file starts as a sealed one does, right or wrong.
bool has_seal(const std::filesystem::path& path);

/// Throws InputError unless the file can be read, has a seal and the seal is right.
void check_seal(const std::filesystem::path& path);

}  // namespace sandglass
