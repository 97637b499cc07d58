// summary.json, which --resume reads of a finished run. What is accepted must be written and read back as the same.
#include "sandglass/io/summary.h"

#include "fuzz.h"

using namespace sandglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_or_refuse([&] {
    const std::string written = to_json(summary_from_json(std::string(text_of(data, size))));
    require(to_json(summary_from_json(written)) == written);
  });
  return 0;
}
