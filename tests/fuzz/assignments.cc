// Assignments of the command line, one a line. What is accepted must read back from the file that we write.
#include <string>
#include <vector>

#include "fuzz.h"
#include "sandglass/io/config.h"

using namespace sandglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> assignments(1);
  for (const char c : text_of(data, size)) {
    if (c == '\n' && assignments.size() < 100) {
      assignments.emplace_back();
    } else {
      assignments.back() += c;
    }
  }
  read_or_refuse([&] {
    const Config config = read_config_text("", "", "/folder", assignments);
    const std::string written = config_to_toml(config);
    require(config_to_toml(read_config_text(written, "again.toml", "/elsewhere")) == written);
  });
  return 0;
}
