// Text files read line by line, with what a clear message needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace sandglass {

/// A text file that is being read; nothing longer than a line is kept, and no line may be longer than 64 KiB.
class TextFile {
 public:
  /// Throws InputError unless the file is a regular one that can be read.
  explicit TextFile(const std::filesystem::path& path);

  /// The next line into `line`, without its end; false at the end of the file.
  bool next(std::string& line);
  /// The same where the file may not end: InputError naming `what` is missing.
  void require(std::string& line, std::string_view what);

  /// A count of particles: a whole number for which the rest of the file has room, at four bytes each.
  [[nodiscard]] std::size_t particle_count(std::string_view text) const;
  [[nodiscard]] double number(std::string_view text) const;  ///< finite, else InputError
  [[nodiscard]] std::int64_t whole_number(std::string_view text) const;
  [[noreturn]] void refuse(const std::string& why) const;  ///< InputError with file and line

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  std::uintmax_t size_ = 0;
  std::uint64_t line_ = 0;
};

/// The words of a line, apart by blanks.
void split(std::string_view line, std::vector<std::string_view>& words);

}  // namespace sandglass
