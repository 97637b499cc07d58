// Frames of other programs, extended XYZ or LAMMPS dumps, told apart by how they begin, as `sandglass analyze` reads
// them.
#include "sandglass/io/frames.h"

#include <cmath>

#include "fuzz.h"
#include "memory_file.h"

using namespace sandglass;

namespace {

/// What is accepted can be measured: as many disks as at first, all numbers finite.
void read(const std::filesystem::path& path, const FrameOptions& options) {
  FrameReader reader(path, options);
  const State& disks = reader.disks();
  require(disks.size() >= 2 && std::isfinite(disks.box_length) && disks.box_length > 0);
  require(std::isfinite(disks.mixture.radius[big]) && std::isfinite(disks.mixture.mass[big]));
  Frame frame;
  while (reader.next(frame)) {
    require(frame.x.size() == disks.size());
    for (std::size_t i = 0; i < disks.size(); ++i) {
      require(std::isfinite(frame.x[i]) && std::isfinite(frame.y[i]));
      require(std::isfinite(frame.vx[i]) && std::isfinite(frame.vy[i]));
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (text_of(data, size).starts_with("\x89HDF")) return 0;  // HDF5 has targets of its own
  static MemoryFile file;
  file.fill(data, size);
  for (const std::vector<double>& radii : {std::vector<double>{}, {1}, {1, 1.43}})
    read_or_refuse([&] { read(file.path(), {.radii = radii}); });
  return 0;
}
