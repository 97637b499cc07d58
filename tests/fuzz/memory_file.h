// A file for readers that want a path, on no disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace sandglass {

/// In the folder of shared memory, where there is one; gone with the object.
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  void fill(const std::uint8_t* data, std::size_t size);
  [[nodiscard]] std::string contents() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace sandglass
