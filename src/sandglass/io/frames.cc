#include "sandglass/io/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>

#include "sandglass/core/errors.h"
#include "sandglass/io/apart.h"
#include "sandglass/io/h5md.h"
#include "sandglass/io/lammps.h"
#include "sandglass/io/xyz.h"

namespace sandglass {
namespace {

// Squares of velocities are summed to 6e-14 and up to 5e24 (ExactSum): between these speeds to four digits and more.
constexpr double least_speed = 1e-5, most_speed = 1e9;

enum class Format { h5md, lammps, xyz };

Format format_of(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw InputError(fmt::format("{} is not there or not a file: check the path", path.string()));
  std::array<char, 8> begin{};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  const std::string_view text(begin.data(), begin.size());
  if (text == "\x89HDF\r\n\x1a\n") return Format::h5md;
  return text.starts_with("ITEM:") ? Format::lammps : Format::xyz;
}

}  // namespace

FrameReader::FrameReader(const std::filesystem::path& path, const FrameOptions& options)
    : path_(path), options_(options) {
  const Format format = format_of(path);
  source_ = format == Format::h5md ? open_h5md(path) : format == Format::lammps ? open_lammps(path) : open_xyz(path);
  if (!source_(raw_)) refuse("it holds no complete frame");
  pending_ = true;
  identify(raw_);
  counts_collisions_ = format == Format::h5md && raw_.step >= 0 && steps_are_collisions(path);
}

void FrameReader::refuse(const std::string& why) const { throw InputError(fmt::format("{}: {}", path_.string(), why)); }

void FrameReader::identify(const RawFrame& first) {
  const std::size_t n = first.x.size();
  if (!first.id.empty()) {
    ids_ = first.id;
    std::sort(ids_.begin(), ids_.end());
    if (std::adjacent_find(ids_.begin(), ids_.end()) != ids_.end()) refuse("two particles have the same id");
  }
  disks_.disks.resize(n);
  set_species(first);
  disks_.box_length = first.box_length / length_unit_;
  if (!std::isfinite(disks_.box_length)) refuse("the box is too large to be counted in radii of its smallest disk");
  has_velocities_ = !first.vx.empty();
  if (!has_velocities_)
    decisions_.emplace_back(
        "The file has no velocities: what depends on them (temperature, velocity autocorrelation, "
        "velocity structure) was not measured.");
  if (!first.unwrapped && first.image_x.empty())
    decisions_.emplace_back(
        "The file does not say how often disks have crossed the box: each was followed to its nearest image from frame "
        "to frame.");
  if (!first.has_time)
    decisions_.push_back(fmt::format("The file has no times: they are {} times {}.", options_.timestep,
                                     first.step >= 0 ? "the step" : "the number of the frame"));
}

/// Two classes of disks by radius, or by kind with the radii of the options.
void FrameReader::set_species(const RawFrame& first) {
  const std::size_t n = first.x.size();
  std::vector<double> radius = first.radius;
  if (radius.empty()) {
    std::map<std::string, double> kinds;
    for (const std::string& kind : first.kind) {
      kinds.emplace(kind, 0);
      if (kinds.size() > 2) break;
    }
    if (kinds.empty()) kinds.emplace("", 0);
    if (kinds.size() > 2)
      refuse("there are more than two kinds of particles, and no radii that tell two species apart");
    if (options_.radii.size() != kinds.size())
      refuse(
          fmt::format("it has {} kind(s) of particles but no radii: give them with --radii, in the order of their "
                      "names and in the unit of length of the file, as in --radii {}",
                      kinds.size(), kinds.size() == 2 ? "1,1.43" : "1"));
    std::size_t next = 0;
    for (auto& [kind, r] : kinds) r = options_.radii[next++];
    for (std::size_t i = 0; i < n; ++i) radius.push_back(kinds.at(first.kind.empty() ? "" : first.kind[i]));
  }
  const auto [least, most] = std::minmax_element(radius.begin(), radius.end());
  const double small_radius = *least, big_radius = *most;
  if (!(small_radius > 0) || !std::isfinite(big_radius)) refuse("a radius is not positive");
  length_unit_ = small_radius;
  std::vector<double> mass = first.mass;
  if (mass.empty()) {
    for (const double r : radius) mass.push_back(r * r);
    decisions_.emplace_back("The file has no masses: they were taken as the areas of the disks.");
  }
  std::array<double, species_count> class_mass{};
  places_.resize(n);
  std::iota(places_.begin(), places_.end(), 0);
  if (!ids_.empty())
    std::sort(places_.begin(), places_.end(), [&](std::size_t a, std::size_t b) { return first.id[a] < first.id[b]; });
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t place = places_[i];
    const Species species = radius[place] == small_radius ? small : big;
    if (species == big && radius[place] != big_radius)
      refuse(fmt::format("radii {}, {} and {} make more than two species", small_radius, radius[place], big_radius));
    if (class_mass[species] == 0) class_mass[species] = mass[place];
    if (!(mass[place] > 0) || mass[place] != class_mass[species])
      refuse("the disks of a species must have one positive mass");
    disks_.disks[i].species = species;
  }
  const double mass_unit = class_mass[small];
  disks_.mixture.radius = {1, big_radius / small_radius};
  disks_.mixture.mass = {1, class_mass[big] > 0 ? class_mass[big] / mass_unit : 1};
  if (!std::isfinite(disks_.mixture.radius[big]) || !std::isfinite(disks_.mixture.mass[big]))
    refuse("radii or masses of the two species differ by more than a number can say");
}

bool FrameReader::next(Frame& frame) {
  if (!pending_ && !source_(raw_)) {
    if (fastest_ > 0 && fastest_ < least_speed)
      refuse(fmt::format(
          "all disks are slower than {:g} radii of the smallest disk per unit of time, and sums of squares would lose "
          "their digits: write times and velocities in a longer unit of time",
          least_speed));
    return false;
  }
  pending_ = false;
  const std::size_t n = disks_.size();
  if (raw_.x.size() != n) refuse(fmt::format("frame {} has {} particles, the first one {}", frames_, raw_.x.size(), n));
  if (std::fabs(raw_.box_length / length_unit_ - disks_.box_length) > 1e-9 * disks_.box_length)
    refuse(fmt::format("the box of frame {} has another size than that of the first", frames_));
  if (raw_.id.empty() != ids_.empty() || raw_.vx.empty() == has_velocities_)
    refuse(fmt::format("frame {} has other columns than the first", frames_));
  if (!ids_.empty()) {
    std::iota(places_.begin(), places_.end(), 0);
    std::sort(places_.begin(), places_.end(), [&](std::size_t a, std::size_t b) { return raw_.id[a] < raw_.id[b]; });
    for (std::size_t i = 0; i < n; ++i)
      if (raw_.id[places_[i]] != ids_[i]) refuse(fmt::format("frame {} has other ids than the first", frames_));
  }
  frame.resize(n);
  const bool stepped = raw_.step >= 0;
  frame.time = raw_.has_time
                   ? raw_.time
                   : options_.timestep * static_cast<double>(stepped ? static_cast<std::uint64_t>(raw_.step) : frames_);
  frame.collisions_per_disk = counts_collisions_ ? 2 * static_cast<double>(raw_.step) / static_cast<double>(n) : 0;
  unwrap(raw_, &RawFrame::x, &RawFrame::image_x, last_x_);
  unwrap(raw_, &RawFrame::y, &RawFrame::image_y, last_y_);
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    frame.x[i] = last_x_[i], frame.y[i] = last_y_[i];
    frame.vx[i] = has_velocities_ ? raw_.vx[places_[i]] / length_unit_ : 0;
    frame.vy[i] = has_velocities_ ? raw_.vy[places_[i]] / length_unit_ : 0;
    fastest = std::max({fastest, std::fabs(frame.vx[i]), std::fabs(frame.vy[i])});
    if (!(std::fabs(frame.vx[i]) <= most_speed) || !(std::fabs(frame.vy[i]) <= most_speed))
      refuse(
          fmt::format("a disk of frame {} is faster than {:g} radii of the smallest disk per unit of time, and sums of "
                      "squares would overflow: write times and velocities in a shorter unit of time",
                      frames_, most_speed));
  }
  slow_frames_ += fastest > 0 && fastest < least_speed;
  fastest_ = std::max(fastest_, fastest);
  ++frames_;
  return true;
}

/// Fills `target`, which holds the coordinates of the frame before, with those of this one.
void FrameReader::unwrap(const RawFrame& raw, std::vector<double> RawFrame::*coordinate,
                         std::vector<std::int64_t> RawFrame::*image, std::vector<double>& target) {
  const double length = disks_.box_length;
  const bool first = target.empty(), by_image = !(raw.*image).empty();
  target.resize(disks_.size());
  for (std::size_t i = 0; i < target.size(); ++i) {
    const std::size_t place = places_[i];
    double c = (raw.*coordinate)[place] / length_unit_;
    if (!(std::fabs(c) < 1e6 * length)) refuse(fmt::format("a disk of frame {} is a million boxes away", frames_));
    if (by_image) {
      const std::int64_t boxes = (raw.*image)[place];
      if (boxes > 1000000 || boxes < -1000000)
        refuse(fmt::format("a disk of frame {} is a million boxes away", frames_));
      c += static_cast<double>(boxes) * length;
    } else if (!raw.unwrapped && !first) {
      const double step = c - target[i], nearest = step - length * std::nearbyint(step / length);
      largest_step_ = std::max(largest_step_, std::fabs(nearest) / length);
      c = target[i] + nearest;
    }
    target[i] = c;
  }
}

void read_all_frames(const std::filesystem::path& path, const FrameOptions& options) {
  FrameReader reader(path, options);
  Frame frame;
  while (reader.next(frame)) {
  }
}

void try_all_frames(const std::filesystem::path& path, const FrameOptions& options) {
  try_apart(path, [&] { read_all_frames(path, options); });
}

}  // namespace sandglass
