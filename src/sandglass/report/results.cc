#include "sandglass/report/results.h"

#include <string>

#include "sandglass/io/hdf5.h"

namespace sandglass {

std::vector<Dataset> read_results(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  std::vector<Dataset> results;
  auto read = [&](const std::string& object) {
    if (!file.has(object)) return;
    const Shape shape = file.shape(object);
    results.push_back({object, shape, file.read<double>(object, shape), file.text_attribute(object, "unit")});
  };
  for (const char* species : {"all", "small", "big"}) {
    for (const char* quantity : {"mean_square_displacement", "velocity_autocorrelation", "self_intermediate_scattering",
                                 "gaussian_approximation"}) {
      for (const char* part : {"time", "collisions", "value", "error", "wavenumber", "equal_time_value"})
        read("/dynamics/" + std::string(species) + "/" + quantity + "/" + part);
    }
  }
  for (const char* part : {"time", "collisions", "temperature_all", "temperature_small", "temperature_big"})
    read("/timeseries/" + std::string(part));
  return results;
}

}  // namespace sandglass
