#include "sandglass/io/observables.h"

#include "sandglass/io/atomic_file.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"

namespace sandglass {

void write_observables(const std::filesystem::path& path, const std::vector<Dataset>& datasets) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    Hdf5File file = Hdf5File::create(temporary, seal_size);
    for (const Dataset& dataset : datasets) {
      std::visit([&](const auto& values) { file.write(dataset.path, dataset.shape, std::span(values)); },
                 dataset.values);
      file.set_attribute(dataset.path, "unit", dataset.unit);
      for (const auto& [name, value] : dataset.attributes)
        file.set_attribute<double>(dataset.path, name, std::span(&value, 1));
    }
    file.close();
    seal_file(temporary);
  });
}

}  // namespace sandglass
