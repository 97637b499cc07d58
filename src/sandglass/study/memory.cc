#include "sandglass/study/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

// Measured: the greatest resident sets of runs with all measurements at N = 10^5 and 4 * 10^5, 94 and 307 MB.
constexpr double bytes_of_program = 2.4e7, bytes_per_disk = 710;

constexpr double unlimited = std::numeric_limits<double>::infinity();

double machine_memory() {
  std::ifstream file("/proc/meminfo");
  double kilobytes = 0;
  bool known = false;
  std::string key, unit;
  double value = 0;
  for (; file >> key >> value; std::getline(file, unit)) {
    if (key != "MemAvailable:" && key != "SwapFree:") continue;
    kilobytes += value;
    known = true;
  }
  return known ? 1024 * kilobytes : unlimited;
}

double group_memory() {
  double limit = 0;
  return std::ifstream("/sys/fs/cgroup/memory.max") >> limit ? limit : unlimited;  // "max" is not a number
}

double process_memory() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  return static_cast<double>(limit.rlim_cur);
}

}  // namespace

double needed_memory(std::uint64_t particles) {
  return bytes_of_program + bytes_per_disk * static_cast<double>(particles);
}

double available_memory() { return std::min({machine_memory(), group_memory(), process_memory()}); }

void require_memory(std::uint64_t particles) {
  const double needed = needed_memory(particles), available = available_memory();
  if (needed <= available) return;
  throw InputError(fmt::format(
      "{} disks need about {:.2g} GB of memory, and this process can have {:.2g} GB: set system.particles to at most "
      "{:.0f}, or take a machine with more memory",
      particles, needed / 1e9, available / 1e9,
      std::max(0.0, std::floor((available - bytes_of_program) / bytes_per_disk))));
}

}  // namespace sandglass
