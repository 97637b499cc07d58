// A trajectory of another program or of ours, as a start (prepare.file). Read in this process, to see every fault.
#include "sandglass/io/trajectory.h"

#include <hdf5.h>

#include <algorithm>

#include "fuzz.h"
#include "hdf5_mutator.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/prepare/file.h"

using namespace sandglass;

namespace {

constexpr std::size_t disks = 4;

State spread_state() {
  State state = sample_state(disks);
  for (std::size_t id = 0; id < disks; ++id) state.disks[id].x = 10 * static_cast<double>(id);
  return state;
}

}  // namespace

void write_seed(const std::filesystem::path& path) {
  const State state = spread_state();
  Frame frame;
  make_frame(state, frame);
  create_trajectory(path, state, 2);
  write_frame(path, 0, 5, frame, state.box_length);
  // As other programs write them: a checksum would keep what is changed from the code behind it.
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(file, frame_checksums, H5P_DEFAULT);
  H5Fclose(file);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  file.fill(data, size);
  read_or_refuse([&] {
    const State state = read_last_frame(file.path());
    const auto smalls =
        std::count_if(state.disks.begin(), state.disks.end(), [](const Disk& d) { return d.species == small; });
    const auto small_count = static_cast<std::size_t>(smalls);
    adapt_state(state, small_count, state.size() - small_count, state.mixture, packing_fraction(state), 1);
  });
  return 0;
}
