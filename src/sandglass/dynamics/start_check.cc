#include "sandglass/dynamics/start_check.h"

#include <cmath>
#include <string>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw InputError(message);
}

void check_disk(const Disk& disk, std::size_t id, const State& state) {
  const std::string name = "disk " + std::to_string(id);
  require(disk.x >= 0 && disk.x < state.box_length && disk.y >= 0 && disk.y < state.box_length,
          name + " is not inside the box [0, L): centres must be wrapped into it");
  require(std::isfinite(disk.vx) && std::isfinite(disk.vy), name + " has a velocity that is not a finite number");
  require(disk.time <= state.now, name + " has a record from the future: the state is damaged");
  require(disk.last_contact <= state.now && disk.next_kick >= state.now,
          name + " has a collision or kick time out of order: the state is damaged");
  require(disk.species == small || disk.species == big, name + " is of no known species");
}

}  // namespace

void check_start(const State& state) {
  require(state.size() >= 2, "a simulation needs at least 2 disks");
  require(state.size() < 0xffffffffu, "more disks than a 32-bit id can name");
  for (const double radius : state.mixture.radius)
    require(radius > 0 && std::isfinite(radius), "radii must be positive numbers");
  for (const double mass : state.mixture.mass)
    require(mass > 0 && std::isfinite(mass), "masses must be positive numbers");
  require(std::isfinite(state.box_length) && state.box_length >= minimum_box_length(state.mixture),
          "the box is too small: its side is " + std::to_string(state.box_length) + " R_s and must be at least " +
              std::to_string(minimum_box_length(state.mixture)) +
              " (8 radii of the largest disk), or a disk could touch two images of another: use more particles");
  require(state.epoch_length > 0 && std::isfinite(state.epoch_length), "the epoch length must be positive");
  require(state.now >= 0 && state.now <= state.epoch_length, "the state's time is outside its epoch");
  const double restitution = state.collision.restitution;
  require(restitution > 0 && restitution <= 1, "the restitution must be in (0, 1]");
  const Drive& drive = state.drive;
  if (drive.kind != DriveKind::none) {
    require(drive.frequency > 0 && std::isfinite(drive.frequency), "a driven state needs a positive kick frequency");
    require(drive.amplitude >= 0 && std::isfinite(drive.amplitude), "the kick amplitude must be a number >= 0");
  }
  if (drive.kind == DriveKind::pair && drive.partner == PartnerRule::within)
    require(drive.reach >= 1 && drive.reach * minimum_box_length(state.mixture) / 4 <= state.box_length / 2,
            "drive.reach must be at least 1 (contact) and reach at most half the box: lower it or use more particles");
  for (std::size_t id = 0; id < state.size(); ++id) check_disk(state.disks[id], id, state);
}

}  // namespace sandglass
