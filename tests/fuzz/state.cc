// A state file. The seal is made right for every input, so that what stands behind it is reached.
#include "sandglass/io/state_file.h"

#include "fuzz.h"
#include "hdf5_mutator.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/seal.h"

using namespace sandglass;

void write_seed(const std::filesystem::path& path) { write_state(path, sample_state(3)); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  file.fill(data, size);
  if (size >= seal_size) seal_file(file.path());
  read_or_refuse([&] {
    const State state = read_state(file.path());
    static MemoryFile copy;
    write_state(copy.path(), state);
    require(state_hash(read_state(copy.path())) == state_hash(state));
  });
  return 0;
}
