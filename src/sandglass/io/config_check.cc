#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/io/config.h"
#include "sandglass/observe/scattering.h"
#include "sandglass/prepare/insert.h"

namespace sandglass {
namespace {

constexpr double quench_least = 0.01;

std::uint64_t big_count(const Config::System& system, std::uint64_t particles) {
  return static_cast<std::uint64_t>(std::llround(system.big_fraction * static_cast<double>(particles)));
}

/// Whether big_fraction * particles is a whole number, up to the rounding of a decimal fraction.
bool divides(const Config::System& system, std::uint64_t particles) {
  const double big = system.big_fraction * static_cast<double>(particles);
  return std::fabs(big - std::round(big)) <= 1e-12 * static_cast<double>(particles);
}

Mixture mixture_of(const Config::System& system) {
  const double ratio = system.size_ratio;
  return {.radius = {1, ratio}, .mass = {1, ratio * ratio}};
}

double box_length(const Config::System& system, std::uint64_t particles) {
  const std::uint64_t big = big_count(system, particles);
  return box_length_for(mixture_of(system), particles - big, big, system.packing_fraction);
}

bool fits(const Config::System& system, std::uint64_t particles) {
  return box_length(system, particles) >= minimum_box_length(mixture_of(system));
}

/// The smallest number of disks that both divides into the species and fills a box of the least size.
std::uint64_t least_particles(const Config::System& system) {
  std::uint64_t particles = system.particles;
  while (!(fits(system, particles) && divides(system, particles))) ++particles;
  return particles;
}

void check_system(const Config::System& system) {
  if (!divides(system, system.particles)) {
    const bool halves = system.big_fraction == 0.5;
    throw InputError(
        fmt::format("system.particles = {} {}: system.big_fraction = {} of them must be a whole number of disks; "
                    "change one of the two",
                    system.particles, halves ? "is odd" : "cannot be divided", system.big_fraction));
  }
  if (!fits(system, system.particles)) {
    throw InputError(fmt::format(
        "the box is too small: with system.particles = {} at system.packing_fraction = {} its side is less than 8 big "
        "radii, and nearest images would not be unique; set system.particles to at least {}",
        system.particles, system.packing_fraction, least_particles(system)));
  }
}

void check_prepare(const Config& config) {
  const double eta = config.system.packing_fraction;
  const auto& prepare = config.prepare;
  if (prepare.method == PrepareMethod::insert && eta > insert_limit) {
    throw InputError(
        fmt::format("system.packing_fraction = {} cannot be reached by random insertion, which ends at {}: set "
                    "prepare.method = \"quench\"",
                    eta, insert_limit));
  }
  if (prepare.method == PrepareMethod::quench && eta < quench_least) {
    throw InputError(fmt::format(
        "system.packing_fraction = {} is too dilute to come from a quench (least {}): set prepare.method = \"insert\"",
        eta, quench_least));
  }
  if (prepare.method == PrepareMethod::quench && eta >= prepare.jammed_fraction) {
    throw InputError(
        fmt::format("prepare.jammed_fraction = {} must be above system.packing_fraction = {}: the quenched packing is "
                    "expanded to it",
                    prepare.jammed_fraction, eta));
  }
  if (prepare.method != PrepareMethod::file) {
    if (prepare.file.empty()) return;
    throw InputError(
        "prepare.file is given, but prepare.method makes a start of its own: set prepare.method = \"file\" or remove "
        "prepare.file");
  }
  if (prepare.file.empty()) {
    throw InputError("prepare.method = \"file\" needs prepare.file, the state, checkpoint or trajectory to start from");
  }
}

/// Partners are looked for among nearest images only.
void check_reach(const Config& config) {
  if (config.drive.kind != DriveKind::pair || config.drive.partner != PartnerRule::within) return;
  const double length = box_length(config.system, config.system.particles);
  const double most = length / (4 * std::max(1.0, config.system.size_ratio));
  if (config.drive.reach <= most) return;
  throw InputError(
      fmt::format("drive.reach = {} contact distances is more than half the box of side {:.4g}: set it to at most "
                  "{:.4g}, or use more particles",
                  config.drive.reach, length, most));
}

void check_wavenumbers(const Config& config) {
  const double most = most_waves * 2 * std::numbers::pi / box_length(config.system, config.system.particles);
  for (const double wavenumber : config.observe.wavenumbers) {
    if (wavenumber <= most) continue;
    throw InputError(fmt::format(
        "observe.wavenumbers: {} is too large for a box of so many wavelengths: at most {}, in 1/R_s, can be "
        "evaluated with this number of disks",
        wavenumber, std::floor(most * 1000) / 1000));
  }
}

}  // namespace

void check_config(const Config& config) {
  check_system(config.system);
  check_prepare(config);
  check_reach(config);
  check_wavenumbers(config);
  if (config.collision.restitution == 1 && config.drive.kind != DriveKind::none) {
    throw InputError(
        "collision.restitution = 1 with driving has no steady state: nothing takes out the energy that kicks put in; "
        "set "
        "drive.kind = \"none\" or collision.restitution below 1");
  }
  // The steady state is reached, and calibrated, over some 1 / (1 - eps^2) collisions per disk.
  if (config.collision.restitution > 0.999 && config.drive.kind != DriveKind::none) {
    throw InputError(
        fmt::format("collision.restitution = {} with driving takes too long to become steady (thousands of collisions "
                    "per disk): set it to at most 0.999, or to 1 with drive.kind = \"none\"",
                    config.collision.restitution));
  }
  if (2 * static_cast<double>(config.run.intervals) > config.run.collisions) {
    throw InputError(fmt::format(
        "run.intervals = {} is too many for run.collisions = {}: an interval must be at least two collisions per disk "
        "long; set run.intervals to at most {}, or run.collisions to at least {}",
        config.run.intervals, config.run.collisions, std::max(1.0, std::floor(config.run.collisions / 2)),
        2 * config.run.intervals));
  }
  if (config.observe.bin_width > 0 && config.observe.bin_width < 0.001) {
    throw InputError(fmt::format(
        "observe.bin_width = {} would cut g(r) into bins too fine to count in: set it to at least 0.001, or to 0 for "
        "L / 800",
        config.observe.bin_width));
  }
  if (!(config.observe.exponent_from < config.observe.exponent_to)) {
    throw InputError(fmt::format(
        "observe.exponent_from = {} is not before observe.exponent_to = {}: the exponent of the MSD needs a range of "
        "times, such as 1 to 10",
        config.observe.exponent_from, config.observe.exponent_to));
  }
  if (const double frames = config.observe.structure_frames.value_or(0); frames != std::floor(frames)) {
    throw InputError(fmt::format("observe.structure_frames = {} must be a whole number or \"auto\"", frames));
  }
  if (config.output.trajectory_frames == 1) {
    throw InputError(
        "output.trajectory_frames = 1: both ends of the measured stretch are stored, so set it to 0 (no file) or at "
        "least 2");
  }
}

}  // namespace sandglass
