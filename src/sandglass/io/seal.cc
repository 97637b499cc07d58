#include "sandglass/io/seal.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

constexpr std::string_view name = "sandglass seal";

/// The seal that belongs to what follows the first block.
std::string compute_seal(std::ifstream& file) {
  std::vector<char> block(1 << 16);
  Checksum checksum;
  std::uint64_t length = 0;
  file.seekg(seal_size);
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto got = static_cast<std::size_t>(file.gcount());
    length += got;
    std::memset(block.data() + got, 0, block.size() - got);  // a last word that is not full ends in zeros
    for (std::size_t at = 0; at < got; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, block.data() + at, sizeof word);
      checksum.add(word);
    }
  }
  checksum.add(length);
  std::string seal = fmt::format("{} 1: {} bytes, checksum {:016x}\n", name, length, checksum.value());
  seal.resize(seal_size, '\0');
  return seal;
}

}  // namespace

void seal_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string seal = compute_seal(in);
  if (in.bad()) throw RunError(fmt::format("cannot read {} back: is the disk failing?", path.string()));
  std::fstream out(path, std::ios::binary | std::ios::in | std::ios::out);
  out.write(seal.data(), static_cast<std::streamsize>(seal.size()));
  out.flush();
  if (!out) throw RunError(fmt::format("cannot write {}: is the disk full?", path.string()));
}

bool has_seal(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // a pipe would keep us waiting
  std::ifstream file(path, std::ios::binary);
  std::string start(name.size(), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return start == name;
}

void check_seal(const std::filesystem::path& path) {
  std::error_code error;
  std::ifstream file;
  if (std::filesystem::is_regular_file(path, error)) file.open(path, std::ios::binary);
  if (!file.is_open()) {
    throw InputError(fmt::format("{} is not there or cannot be read: check the path", path.string()));
  }
  std::string found(seal_size, '\0');
  file.read(found.data(), static_cast<std::streamsize>(found.size()));
  if (!found.starts_with(name)) {
    throw InputError(fmt::format("{} is not a state file or a checkpoint of this program", path.string()));
  }
  file.clear();
  if (found != compute_seal(file)) {
    throw InputError(fmt::format("{} is damaged: its checksum is wrong; use another copy", path.string()));
  }
}

}  // namespace sandglass
