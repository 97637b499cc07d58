// observables.h5, read back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sandglass/core/fields.h"

namespace sandglass {

/// A measured function as it stands in observables.h5: datasets of one group. All that reads results walks this list.
struct Quantity {
  std::string group;  ///< for example "/dynamics/small/mean_square_displacement"
  std::vector<std::string>
      axes;  ///< datasets of the arguments, in the order of the indices of the value; none: a number
  std::string value = "value";
  std::string error = "error";  ///< standard error of each value; a file may lack it
  std::string count = "count";  ///< number of samples behind each value; a file may lack it
  std::string companion = {};   ///< a second measure of the last argument ("collisions" beside "time"), or empty

  [[nodiscard]] std::string path(const std::string& dataset) const { return group + "/" + dataset; }
};

/// Every quantity that a run may have measured.
const std::vector<Quantity>& quantities();

/// The datasets of an observables.h5 that `quantities` names; those that are not in the file are left out. Throws
/// InputError where the file cannot be read or its checksum is wrong.
std::vector<Dataset> read_results(const std::filesystem::path& path);

/// The dataset of that path; null when there is none.
const Dataset* find_dataset(const std::vector<Dataset>& results, const std::string& path);

/// Its values as double; empty when there is none.
std::vector<double> numbers_of(const std::vector<Dataset>& results, const std::string& path);

}  // namespace sandglass
