#include "sandglass/io/state_check.h"

#include <fmt/format.h>

#include <cmath>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

// No run comes near these; from above, a counter could overflow in one.
constexpr std::uint64_t most_events = std::uint64_t{1} << 61, most_epochs = std::uint64_t{1} << 52;
constexpr std::int32_t most_images = 1 << 30;

bool positive(double value) { return std::isfinite(value) && value > 0; }
bool not_negative(double value) { return std::isfinite(value) && value >= 0; }

void require(bool good, const std::string& origin, std::string_view what) {
  if (!good) throw InputError(fmt::format("{} cannot be used: {}; use another file", origin, what));
}

void check_disk(const State& state, std::size_t id, const std::string& origin) {
  const Disk& disk = state.disks[id];
  const auto fail = [&](std::string_view what) { require(false, origin, fmt::format("disk {} has {}", id, what)); };
  if (disk.species != small && disk.species != big) fail("a species that is neither small nor big");
  const auto in_box = [&](double c) { return c >= 0 && c <= state.box_length; };
  if (!in_box(disk.x) || !in_box(disk.y)) fail(fmt::format("its centre at ({}, {}), outside the box", disk.x, disk.y));
  if (!std::isfinite(disk.vx) || !std::isfinite(disk.vy)) fail("a velocity that is not a number");
  const auto few = [](std::int32_t images) { return -most_images <= images && images <= most_images; };
  if (!few(disk.image_x) || !few(disk.image_y)) fail("crossed the box more often than can be counted");
  if (disk.kick_count > most_events) fail("been kicked more often than can be counted");
  if (!std::isfinite(disk.time) || disk.time > state.now)
    fail(fmt::format("a record of time {}, in the future", disk.time));
  if (!(disk.last_contact <= state.now)) fail(fmt::format("its last contact at {}, in the future", disk.last_contact));
  if (!(disk.next_kick >= state.now)) fail(fmt::format("its next kick at {}, in the past", disk.next_kick));
}

}  // namespace

void check_state(const State& state, const std::string& origin) {
  require(positive(state.box_length), origin, fmt::format("the side of its box is {}", state.box_length));
  for (int species = 0; species < species_count; ++species) {
    require(positive(state.mixture.radius[species]), origin, "a radius is not positive");
    require(positive(state.mixture.mass[species]), origin, "a mass is not positive");
  }
  const CollisionLaw& law = state.collision;
  require(law.restitution > 0 && law.restitution <= 1, origin, fmt::format("its restitution is {}", law.restitution));
  require(law.collapse <= CollapsePolicy::tc && not_negative(law.collapse_time), origin,
          "its collapse policy is unknown");
  const Drive& drive = state.drive;
  require(drive.kind <= DriveKind::single && drive.partner <= PartnerRule::within, origin, "its drive is unknown");
  require(positive(drive.reach) && not_negative(drive.frequency) && not_negative(drive.amplitude), origin,
          "its drive has a value that is negative or not a number");
  require(not_negative(state.epoch_length) && not_negative(state.now) && not_negative(state.time()), origin,
          "its time is negative or not a number");
  require(state.epoch <= most_epochs, origin, fmt::format("it counts {} epochs", state.epoch));
  const Tally& tally = state.tally;
  for (const auto count : {tally.contacts[0], tally.contacts[1], tally.contacts[2], tally.kicks})
    require(count <= most_events, origin, fmt::format("it counts {} events of a kind", count));
  require(tally.elastic_contacts <= tally.collisions(), origin, "its counts contradict each other");
  require(state.size() >= 2 && state.size() <= most_disks, origin, fmt::format("it has {} disks", state.size()));
  for (std::size_t id = 0; id < state.size(); ++id) check_disk(state, id, origin);
}

}  // namespace sandglass
