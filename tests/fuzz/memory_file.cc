#include "memory_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "fuzz.h"

namespace sandglass {

MemoryFile::MemoryFile() {
  static int files = 0;
  const std::filesystem::path shared = "/dev/shm";
  path_ = (std::filesystem::is_directory(shared) ? shared : std::filesystem::temp_directory_path()) /
          fmt::format("sandglass-fuzz-{}-{}", getpid(), ++files);
}

MemoryFile::~MemoryFile() {
  std::error_code error;
  std::filesystem::remove(path_, error);
}

void MemoryFile::fill(const std::uint8_t* data, std::size_t size) {
  std::ofstream(path_, std::ios::binary) << text_of(data, size);
}

std::string MemoryFile::contents() const {
  std::ifstream file(path_, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace sandglass
