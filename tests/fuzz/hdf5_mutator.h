// Mutations of HDF5 files through the library itself: the file stays one, what is in it becomes anything.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace sandglass {

/// A file on no disk: in the folder of shared memory, where there is one.
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

/// Each target of HDF5 files defines it: a small good file, of which all inputs are mutations.
void write_seed(const std::filesystem::path& path);
