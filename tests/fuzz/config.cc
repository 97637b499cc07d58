// A configuration file. What is accepted must be written and read back as the same configuration.
#include "sandglass/io/config.h"

#include "fuzz.h"

using namespace sandglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_or_refuse([&] {
    const Config config = read_config_text(text_of(data, size), "fuzz.toml", "/folder");
    const std::string written = config_to_toml(config);
    Config again;
    try {
      again = read_config_text(written, "again.toml", "/elsewhere");
    } catch (const InputError&) {
      std::abort();  // we cannot read what we wrote
    }
    require(config_to_toml(again) == written);
    require(differing_keys(config, again).empty());
  });
  return 0;
}
