#include "sandglass/io/h5md.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "sandglass/core/errors.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/state_check.h"
#include "sandglass/io/trajectory.h"

namespace sandglass {
namespace {

const std::string all = "/particles/all/";

/// What is the same in all frames, and where we are.
class H5mdFile {
 public:
  explicit H5mdFile(const std::filesystem::path& path) : file_(Hdf5File::open(path)) {
    if (!file_.has(all + "position/value"))
      refuse("it has no /particles/all/position/value: it is no H5MD trajectory of particles called \"all\"");
    shape_ = file_.shape(all + "position/value");
    if (shape_.size() != 3 || shape_[1] < 2 || shape_[1] > most_disks || (shape_[2] != 2 && shape_[2] != 3))
      refuse("positions must be [frame, disk, 2 or 3]");
    constant_.box_length = side_of_box();
    for (const auto& [name, values] : {std::pair{"radius", &constant_.radius}, {"mass", &constant_.mass}})
      if (const std::string object = constant_object(name); !object.empty())
        *values = file_.read<double>(object, {shape_[1]});
    if (const std::string object = constant_object("species"); !object.empty())
      for (const std::int64_t species : file_.read<std::int64_t>(object, {shape_[1]}))
        constant_.kind.push_back(std::to_string(species));
    if (const std::string object = constant_object("id"); !object.empty())
      constant_.id = file_.read<std::int64_t>(object, {shape_[1]});
    velocities_ = file_.has(all + "velocity/value");
    images_ = file_.has(all + "image/value");
    times_ = moments<double>("time");
    steps_ = moments<std::int64_t>("step");
    if (file_.has(frame_checksums)) checksums_ = file_.read<std::uint64_t>(frame_checksums, {shape_[0]});
  }

  bool next(RawFrame& frame) {
    if (next_ == shape_[0] || (!steps_.empty() && steps_[next_] < 0)) return false;
    frame = constant_;
    if (!steps_.empty()) frame.step = steps_[next_];
    if (!times_.empty()) {
      if (!std::isfinite(times_[next_])) refuse(fmt::format("the time of frame {} is not a number", next_));
      frame.time = times_[next_], frame.has_time = true;
    }
    Checksum checksum;
    read_plane("position", frame.x, frame.y, checksum);
    if (velocities_) read_plane("velocity", frame.vx, frame.vy, checksum);
    if (images_) read_plane("image", frame.image_x, frame.image_y, checksum);
    checksum.add(frame.time);
    checksum.add(frame.step);
    if (!checksums_.empty() && checksum.value() != checksums_[next_]) refuse(wrong_checksum(next_));
    ++next_;
    return true;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(fmt::format("{}: {}", file_.path().string(), why));
  }

  /// A dataset that does not depend on time; not every element need be there, but not in frames.
  [[nodiscard]] std::string constant_object(const std::string& name) const {
    if (!file_.has(all + name)) return {};
    if (file_.has(all + name + "/value"))
      refuse(fmt::format("{} changes with time: it must be one list for all", name));
    return all + name;
  }

  [[nodiscard]] double side_of_box() const {
    const bool framed = file_.has(all + "box/edges/value");
    const std::string object = all + (framed ? "box/edges/value" : "box/edges");
    if (!file_.has(object)) refuse("it has no box/edges: the side of the periodic box must be known");
    const Shape shape = file_.shape(object);
    if (shape.size() != (framed ? 2 : 1) || (shape.back() != 2 && shape.back() != 3))
      refuse("the edges of the box must be two or three numbers (a box that is not tilted)");
    const auto edges = framed ? file_.read_row<double>(object, 0, {shape.back()}) : file_.read<double>(object, shape);
    if (!(edges[0] > 0) || !std::isfinite(edges[0]) || std::fabs(edges[0] - edges[1]) > 1e-9 * edges[0])
      refuse("the box is not a square");
    return edges[0];
  }

  /// Times or steps of the frames: one for each, or the increment from frame to frame.
  template <class T>
  [[nodiscard]] std::vector<T> moments(const std::string& name) const {
    const std::string object = all + "position/" + name;
    if (!file_.has(object)) return {};
    if (!file_.shape(object).empty()) return file_.read<T>(object, {shape_[0]});
    const T increment = file_.read<T>(object, {})[0];
    if (!(increment > 0) || !(increment < T(1e15)) || shape_[0] > 1000000000)
      refuse(name + ": an increment must be positive");
    std::vector<T> values;
    for (std::size_t i = 0; i < shape_[0]; ++i) values.push_back(static_cast<T>(i) * increment);
    return values;
  }

  template <class T>
  void read_plane(const std::string& name, std::vector<T>& x, std::vector<T>& y, Checksum& checksum) const {
    const std::string object = all + name + "/value";
    const Shape shape = file_.shape(object);
    if (shape.size() != 3 || (shape[2] != 2 && shape[2] != 3)) refuse(name + " must be [frame, disk, 2 or 3]");
    const auto values = file_.read_row<T>(object, next_, {shape_[1], shape[2]});
    checksum.add_all<T>(values);
    for (std::size_t id = 0; id < shape_[1]; ++id) {
      if (!std::isfinite(static_cast<double>(values[shape[2] * id] + values[shape[2] * id + 1])))
        refuse(fmt::format("frame {}: the {} of disk {} is not a number", next_, name, id));
      x.push_back(values[shape[2] * id]);
      y.push_back(values[shape[2] * id + 1]);
    }
  }

  Hdf5File file_;
  Shape shape_;
  RawFrame constant_;
  bool velocities_ = false, images_ = false;
  std::vector<double> times_;
  std::vector<std::int64_t> steps_;
  std::vector<std::uint64_t> checksums_;
  std::size_t next_ = 0;
};

}  // namespace

RawFrames open_h5md(const std::filesystem::path& path) {
  auto file = std::make_shared<H5mdFile>(path);
  return [file](RawFrame& frame) { return file->next(frame); };
}

bool steps_are_collisions(const std::filesystem::path& path) {
  try {
    return Hdf5File::open(path).text_attribute("/h5md/creator", "name") == "sandglass";
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace sandglass
