#include "sandglass/study/start.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/epoch.h"
#include "sandglass/io/state_file.h"
#include "sandglass/prepare/prepare.h"
#include "sandglass/study/memory.h"
#include "sandglass/theory/enskog.h"

namespace sandglass {
namespace {

Mixture mixture_of(const Config& config) {
  const double ratio = config.system.size_ratio;
  return {.radius = {1.0, ratio}, .mass = {1.0, ratio * ratio}};
}

State prepare(const Config& config, const Progress& progress) {
  const auto [small_count, big_count] = counts_of(config);
  const Mixture mixture = mixture_of(config);
  const double eta = config.system.packing_fraction;
  const std::uint64_t seed = config.run.seed;
  switch (config.prepare.method) {
    case PrepareMethod::insert:
      return insert_disks(small_count, big_count, mixture, eta, seed, progress);
    case PrepareMethod::quench:
      return quench_disks(small_count, big_count, mixture, eta, seed, config.prepare.jammed_fraction, progress);
    case PrepareMethod::file:
      break;
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(config.prepare.file, error))
    throw InputError(
        fmt::format("prepare.file = \"{}\" is not there or not a file: check the path (in a file it is relative to the "
                    "folder of that file)",
                    config.prepare.file));
  return adapt_state(read_start_file(config.prepare.file), small_count, big_count, mixture, eta, seed);
}

}  // namespace

double beat_of(const Config& config) {
  return mean_free_time(mixture_of(config), config.system.big_fraction, config.system.packing_fraction,
                        config.drive.temperature);
}

Counts counts_of(const Config& config) {
  const auto all = static_cast<std::size_t>(config.system.particles);
  const auto big_count = static_cast<std::size_t>(std::llround(static_cast<double>(all) * config.system.big_fraction));
  return {all - big_count, big_count};
}

Config smaller_config(const Config& config, std::uint64_t least) {
  Config smaller = config;
  for (smaller.system.particles = least; smaller.system.particles < config.system.particles;
       ++smaller.system.particles) {
    try {
      check_config(smaller);
      return smaller;
    } catch (const InputError&) {  // these are not whole disks of each species, or their box is too small
    }
  }
  return config;
}

Config calibration_config(const Config& config) {
  const bool as_it_is = config.drive.kind == DriveKind::none || config.prepare.method == PrepareMethod::file;
  return as_it_is ? config : smaller_config(config, 100'000);
}

State make_start(const Config& config, const Progress& progress) {
  require_memory(config.system.particles);
  State state = prepare(config, progress);
  const double beat = beat_of(config);
  state.epoch_length = beats_per_epoch * beat;
  state.collision = {config.collision.restitution, config.collision.collapse_policy,
                     config.collision.collapse_time * beat};
  draw_velocities(state, config.drive.temperature);

  Drive& drive = state.drive;
  drive = {};
  drive.kind = config.drive.kind;
  if (drive.kind != DriveKind::none) {
    drive.partner = config.drive.partner;
    drive.reach = config.drive.reach;
    drive.frequency = config.drive.frequency.value_or(1 / beat);
    drive.amplitude = drive_amplitude(state.mixture, config.system.big_fraction, config.collision.restitution,
                                      config.drive.temperature, drive.frequency, 1 / beat);
  }
  start_kick_clocks(state);
  return state;
}

}  // namespace sandglass
