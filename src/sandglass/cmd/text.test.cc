#include "sandglass/cmd/text.h"

#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <limits>
#include <string>

#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

std::string said_by(const std::string& command) {
  std::string out;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::array<char, 4096> piece{};
  while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), pipe)) out.append(piece.data(), got);
  CHECK(::pclose(pipe) == 0);
  return out;
}

}  // namespace

TEST_CASE("durations, also those that are none") {
  CHECK(duration_text(0) == "0 s");
  CHECK(duration_text(200) == "3 min 20 s");
  CHECK(duration_text(3600 * 25) == "25 h 0 min");
  CHECK(duration_text(86400 * 3) == "3 days 0 h");
  CHECK(duration_text(-5) == "0 s");
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, 1e300})
    CHECK(duration_text(none) == "an unknown time");
}

TEST_CASE("a shell reads every word back as it was") {
  CHECK(shell_word("runs/eta=0.80_eps=0.9/config.toml") == "runs/eta=0.80_eps=0.9/config.toml");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("it's") == R"('it'\''s')");
  CHECK(shell_word("a\x1b[31m").find('\x1b') == std::string::npos);
  // Every byte, alone and among the characters that quoting is about. Each word ends with a NUL, which none can hold.
  std::string command = "printf '%s\\0'", expected;
  for (int byte = 1; byte < 256; ++byte) {
    for (const std::string around : {"", "'", "\\", "\n", " $x `y` \"z\" "}) {
      const std::string word = around + static_cast<char>(byte) + around;
      command += ' ' + shell_word(word);
      expected += word + '\0';
    }
  }
  const TemporaryFolder folder;
  spill(folder / "words.sh", command);
  CHECK(said_by("bash " + (folder / "words.sh").string()) == expected);
}
