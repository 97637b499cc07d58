#include "sandglass/io/text_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/io/state_check.h"

namespace sandglass {
namespace {

constexpr std::size_t longest_line = 1 << 16;

}  // namespace

TextFile::TextFile(const std::filesystem::path& path) : path_(path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw InputError(fmt::format("{} is not there or not a file: check the path", path.string()));
  file_.open(path, std::ios::binary);
  size_ = std::filesystem::file_size(path, error);
  if (!file_ || error) throw InputError(fmt::format("{} cannot be read: check its permissions", path.string()));
}

bool TextFile::next(std::string& line) {
  line.clear();
  ++line_;
  std::streambuf& buffer = *file_.rdbuf();
  for (;;) {
    const int c = buffer.sbumpc();
    if (c == std::char_traits<char>::eof()) return !line.empty();
    if (c == '\n') break;
    if (line.size() == longest_line) refuse("the line is longer than 64 KiB; this is no trajectory in text form");
    line.push_back(static_cast<char>(c));
  }
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

void TextFile::require(std::string& line, std::string_view what) {
  if (!next(line))
    refuse(fmt::format("the file ends before {}: it was cut off; remove its last, incomplete frame", what));
}

std::size_t TextFile::particle_count(std::string_view text) const {
  const std::int64_t count = whole_number(text);
  constexpr std::uintmax_t least_bytes = 4;  // "1 2\n"
  if (count < 2 || static_cast<std::uint64_t>(count) > most_disks ||
      static_cast<std::uintmax_t>(count) > size_ / least_bytes)
    refuse(fmt::format("a frame of {} particles is impossible in a file of {} bytes (2 is the least)", count, size_));
  return static_cast<std::size_t>(count);
}

double TextFile::number(std::string_view text) const {
  double value = 0;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    refuse(fmt::format("\"{}\" is not a finite number", text.substr(0, 40)));
  return value;
}

std::int64_t TextFile::whole_number(std::string_view text) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    refuse(fmt::format("\"{}\" is not a whole number", text.substr(0, 40)));
  return value;
}

void TextFile::refuse(const std::string& why) const {
  throw InputError(fmt::format("{}:{}: {}", path_.string(), line_, why));
}

void split(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  constexpr std::string_view blanks = " \t";
  for (std::size_t begin = line.find_first_not_of(blanks); begin != line.npos;
       begin = line.find_first_not_of(blanks, begin)) {
    const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
}

}  // namespace sandglass
