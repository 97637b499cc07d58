#include "sandglass/io/trajectory.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "sandglass/core/errors.h"
#include "sandglass/io/apart.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/state_check.h"

namespace sandglass {
namespace {

constexpr std::int64_t not_written = -1;
const std::string all = "/particles/all/";

template <class T>
void write_constant(Hdf5File& file, const std::string& name, const std::vector<T>& values, const std::string& unit) {
  file.write(all + name, {values.size()}, std::span<const T>(values));
  file.set_attribute(all + name, "unit", unit);
}

/// Room for {step, time, value} of one time-dependent quantity; step and time are one pair for all of them.
template <class T>
void reserve_frames(Hdf5File& file, const std::string& name, std::uint64_t frames, std::size_t disks,
                    const std::string& unit) {
  file.reserve<T>(all + name + "/value", {frames, disks, 2}, T{});
  file.set_attribute(all + name + "/value", "unit", unit);
  if (name == "position") {
    file.reserve<std::int64_t>(all + "position/step", {frames}, not_written);
    file.reserve<double>(all + "position/time", {frames}, std::numeric_limits<double>::quiet_NaN());
    file.set_attribute(all + "position/time", "unit", "R_s (m_s / energy)^(1/2)");
  } else {
    file.link(all + "position/step", all + name + "/step");
    file.link(all + "position/time", all + name + "/time");
  }
}

void write_description(Hdf5File& file) {
  const std::array<std::int64_t, 2> version{1, 1}, units_version{1, 0};
  file.set_attribute<std::int64_t>("/h5md", "version", version);
  file.set_attribute("/h5md/author", "name", "sandglass");
  file.set_attribute("/h5md/creator", "name", "sandglass");
  file.set_attribute("/h5md/creator", "version", SANDGLASS_VERSION);
  file.set_attribute<std::int64_t>("/h5md/modules/units", "version", units_version);
  const std::array<std::int64_t, 1> dimension{2};
  file.set_attribute<std::int64_t>(all + "box", "dimension", dimension);
  file.set_attribute(all + "box", "boundary", std::vector<std::string>{"periodic", "periodic"});
}

void write_disks(Hdf5File& file, const State& state) {
  std::vector<std::uint8_t> species;
  std::vector<double> radius, mass;
  for (const Disk& disk : state.disks) {
    species.push_back(disk.species);
    radius.push_back(state.mixture.radius[disk.species]);
    mass.push_back(state.mixture.mass[disk.species]);
  }
  write_constant(file, "species", species, "");
  write_constant(file, "radius", radius, "R_s");
  write_constant(file, "mass", mass, "m_s");
  write_constant(file, "box/edges", std::vector<double>(2, state.box_length), "R_s");
}

}  // namespace

Wrapped wrap(double coordinate, double box_length) {
  double image = std::floor(coordinate / box_length);
  double position = coordinate - image * box_length;
  // The quotient and the product are rounded: the result may miss [0, L) by a rounding at either end.
  if (position < 0) {
    position += box_length;
    image -= 1;
  }
  if (position >= box_length) {
    position -= box_length;
    image += 1;
  }
  if (!(std::fabs(image) < 0x1p31)) {
    throw RunError(fmt::format("a disk is at {}, too far away to count the boxes it has crossed", coordinate));
  }
  return {position, static_cast<std::int32_t>(image)};
}

void create_trajectory(const std::filesystem::path& path, const State& state, std::uint64_t frames) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    Hdf5File file = Hdf5File::create(temporary);
    write_description(file);
    write_disks(file, state);
    reserve_frames<double>(file, "position", frames, state.size(), "R_s");
    reserve_frames<std::int32_t>(file, "image", frames, state.size(), "");
    reserve_frames<double>(file, "velocity", frames, state.size(), "(energy / m_s)^(1/2)");
    file.reserve<std::uint64_t>(frame_checksums, {frames}, 0);
    file.close();
  });
}

void write_frame(const std::filesystem::path& path, std::uint64_t index, std::int64_t step, const Frame& frame,
                 double box_length) {
  std::vector<double> position, velocity;
  std::vector<std::int32_t> image;
  for (std::size_t id = 0; id < frame.size(); ++id) {
    const Wrapped x = wrap(frame.x[id], box_length), y = wrap(frame.y[id], box_length);
    position.insert(position.end(), {x.position, y.position});
    image.insert(image.end(), {x.image, y.image});
    velocity.insert(velocity.end(), {frame.vx[id], frame.vy[id]});
  }
  Checksum checksum;
  checksum.add_all<double>(position);
  checksum.add_all<double>(velocity);
  checksum.add_all<std::int32_t>(image);
  checksum.add(frame.time);
  checksum.add(step);
  Hdf5File file = Hdf5File::open_to_write(path);
  file.write_row<double>(all + "position/value", index, position);
  file.write_row<std::int32_t>(all + "image/value", index, image);
  file.write_row<double>(all + "velocity/value", index, velocity);
  file.write_row<double>(all + "position/time", index, std::array{frame.time});
  if (file.has(frame_checksums))  // runs of older versions go on without
    file.write_row<std::uint64_t>(frame_checksums, index, std::array{checksum.value()});
  // The step comes last: where it is set, the frame is complete.
  file.write_row<std::int64_t>(all + "position/step", index, std::array{step});
  file.close();
}

std::string wrong_checksum(std::uint64_t frame) {
  return fmt::format(
      "frame {} is damaged or was changed: its checksum is wrong; use another copy, or delete {} from the file if the "
      "change was meant",
      frame, frame_checksums);
}

void check_trajectory(const std::filesystem::path& path, std::size_t disks, std::uint64_t frames) {
  try_apart(path, [&] {
    const Hdf5File file = Hdf5File::open(path);
    const auto require = [&](const std::string& object, const Shape& shape) {
      if (file.shape(object) != shape)
        throw InputError(fmt::format("{}, {}: its shape is not that of this run", path.string(), object));
    };
    for (const char* name : {"position/value", "image/value", "velocity/value"})
      require(all + name, {frames, disks, 2});
    (void)file.read<std::int64_t>(all + "position/step", {frames});
    (void)file.read<double>(all + "position/time", {frames});
    if (file.has(frame_checksums)) require(frame_checksums, {frames});
  });
}

namespace {

/// The last frame whose step is set.
std::size_t last_frame(const Hdf5File& file) {
  const Shape shape = file.shape(all + "position/step");
  if (shape.size() == 1) {
    const auto steps = file.read<std::int64_t>(all + "position/step", shape);
    for (std::size_t i = steps.size(); i-- > 0;) {
      if (steps[i] >= 0) return i;
    }
  }
  throw InputError(fmt::format("{} holds no complete frame; start from another file", file.path().string()));
}

/// Radius and mass by species, which all disks of a species must share.
Mixture read_mixture(const Hdf5File& file, const std::vector<std::uint8_t>& species) {
  const auto radius = file.read<double>(all + "radius", {species.size()});
  const auto mass = file.read<double>(all + "mass", {species.size()});
  Mixture mixture;
  std::array<bool, species_count> seen{};
  for (std::size_t id = 0; id < species.size(); ++id) {
    const std::uint8_t s = species[id];
    if (s < species_count && !seen[s]) mixture.radius[s] = radius[id], mixture.mass[s] = mass[id], seen[s] = true;
    if (s >= species_count || mixture.radius[s] != radius[id] || mixture.mass[s] != mass[id]) {
      throw InputError(
          fmt::format("{}: disk {} is neither of two species of equal radius and mass: only binary mixtures "
                      "can be a start",
                      file.path().string(), id));
    }
  }
  return mixture;
}

}  // namespace

State read_last_frame(const std::filesystem::path& path) {
  const Hdf5File file = Hdf5File::open(path);
  if (!file.has("/h5md") || !file.has(all + "position/value")) {
    throw InputError(fmt::format("{} is neither a state file, a checkpoint nor a trajectory", path.string()));
  }
  const Shape shape = file.shape(all + "species");
  if (shape.size() != 1 || shape[0] > most_disks) {
    throw InputError(fmt::format("{} holds no list of at most {} disks", path.string(), most_disks));
  }
  const auto species = file.read<std::uint8_t>(all + "species", shape);
  State state;
  state.mixture = read_mixture(file, species);
  const auto edges = file.read<double>(all + "box/edges", {2});
  if (edges[0] != edges[1]) throw InputError(fmt::format("{}: the box is not a square", path.string()));
  state.box_length = edges[0];

  const std::size_t frame = last_frame(file);
  const Shape plane{shape[0], 2};
  const auto position = file.read_row<double>(all + "position/value", frame, plane);
  const auto image = file.read_row<std::int32_t>(all + "image/value", frame, plane);
  const auto velocity = file.read_row<double>(all + "velocity/value", frame, plane);
  if (file.has(frame_checksums)) {
    Checksum checksum;
    checksum.add_all<double>(position);
    checksum.add_all<double>(velocity);
    checksum.add_all<std::int32_t>(image);
    checksum.add(file.read_row<double>(all + "position/time", frame, {})[0]);
    checksum.add(file.read_row<std::int64_t>(all + "position/step", frame, {})[0]);
    if (checksum.value() != file.read_row<std::uint64_t>(frame_checksums, frame, {})[0])
      throw InputError(fmt::format("{}: {}", path.string(), wrong_checksum(frame)));
  }
  state.disks.resize(shape[0]);
  for (std::size_t id = 0; id < shape[0]; ++id) {
    Disk& disk = state.disks[id];
    disk.x = position[2 * id], disk.y = position[2 * id + 1];
    disk.image_x = image[2 * id], disk.image_y = image[2 * id + 1];
    disk.vx = velocity[2 * id], disk.vy = velocity[2 * id + 1];
    disk.species = static_cast<Species>(species[id]);
  }
  check_state(state, path.string());
  return state;
}

}  // namespace sandglass
