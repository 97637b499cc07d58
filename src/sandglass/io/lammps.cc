#include "sandglass/io/lammps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sandglass/io/text_file.h"

namespace sandglass {
namespace {

using Words = std::vector<std::string_view>;

struct Side {
  double low = 0, length = 0;
};

Side read_bounds(TextFile& file, std::string& line, Words& words) {
  file.require(line, "the bounds of the box");
  split(line, words);
  if (words.size() != 2) file.refuse("bounds of the box are two numbers, low and high; a tilted box cannot be used");
  Side side{file.number(words[0]), 0};
  side.length = file.number(words[1]) - side.low;
  if (!(side.length > 0) || !std::isfinite(side.length)) file.refuse("the box has no extent");
  return side;
}

/// The columns of a frame by name.
class Columns {
 public:
  Columns(const Words& words, const TextFile& file) : names_(words.begin() + 2, words.end()) {  // after ITEM: ATOMS
    for (const auto& [x, y, scaled, unwrapped] : {std::tuple{"xu", "yu", false, true},
                                                  {"x", "y", false, false},
                                                  {"xsu", "ysu", true, true},
                                                  {"xs", "ys", true, false}}) {
      if (position_x_ >= 0 || find(x) < 0 || find(y) < 0) continue;
      position_x_ = find(x), position_y_ = find(y), scaled_ = scaled, unwrapped_ = unwrapped;
    }
    if (position_x_ < 0) file.refuse("there are no positions: the dump needs x y, xu yu, xs ys or xsu ysu");
    id_ = find("id"), type_ = find("type"), radius_ = find("radius"), diameter_ = find("diameter"),
    mass_ = find("mass");
    if (find("vy") >= 0) velocity_x_ = find("vx"), velocity_y_ = find("vy");
    if (find("iy") >= 0) image_x_ = find("ix"), image_y_ = find("iy");
  }

  [[nodiscard]] std::size_t count() const { return names_.size(); }
  [[nodiscard]] bool unwrapped() const { return unwrapped_; }

  void read(const Words& words, const TextFile& file, const Side& x, const Side& y, RawFrame& frame) const {
    const auto word = [&](int column) { return words[static_cast<std::size_t>(column)]; };
    const auto number = [&](int column) { return file.number(word(column)); };
    frame.x.push_back(scaled_ ? number(position_x_) * x.length : number(position_x_) - x.low);
    frame.y.push_back(scaled_ ? number(position_y_) * y.length : number(position_y_) - y.low);
    if (velocity_x_ >= 0) frame.vx.push_back(number(velocity_x_)), frame.vy.push_back(number(velocity_y_));
    if (image_x_ >= 0 && !unwrapped_) {
      frame.image_x.push_back(file.whole_number(word(image_x_)));
      frame.image_y.push_back(file.whole_number(word(image_y_)));
    }
    if (id_ >= 0) frame.id.push_back(file.whole_number(word(id_)));
    if (type_ >= 0) frame.kind.emplace_back(word(type_));
    if (radius_ >= 0) frame.radius.push_back(number(radius_));
    if (radius_ < 0 && diameter_ >= 0) frame.radius.push_back(number(diameter_) / 2);
    if (mass_ >= 0) frame.mass.push_back(number(mass_));
  }

 private:
  [[nodiscard]] int find(std::string_view name) const {
    const auto place = std::find(names_.begin(), names_.end(), name);
    return place == names_.end() ? -1 : static_cast<int>(place - names_.begin());
  }

  std::vector<std::string> names_;
  int position_x_ = -1, position_y_ = -1, velocity_x_ = -1, velocity_y_ = -1, image_x_ = -1, image_y_ = -1;
  int id_ = -1, type_ = -1, radius_ = -1, diameter_ = -1, mass_ = -1;
  bool scaled_ = false, unwrapped_ = false;
};

bool read_frame(TextFile& file, RawFrame& frame) {
  frame = {};
  std::string line;
  Words words;
  std::size_t count = 0;
  Side x, y;
  bool begun = false;
  const auto value = [&](const char* what) {
    file.require(line, what);
    split(line, words);
    if (words.size() != 1) file.refuse(fmt::format("{} must be one number", what));
    return words[0];
  };
  for (;;) {
    if (!file.next(line)) {
      if (begun) file.refuse("the file ends within a frame: it was cut off; remove its last, incomplete frame");
      return false;
    }
    if (line.empty()) continue;
    begun = true;
    if (line.starts_with("ITEM: TIMESTEP")) {
      frame.step = file.whole_number(value("the timestep"));
    } else if (line.starts_with("ITEM: TIME")) {
      frame.time = file.number(value("the time")), frame.has_time = true;
    } else if (line.starts_with("ITEM: UNITS")) {
      file.require(line, "the units");
    } else if (line.starts_with("ITEM: NUMBER OF ATOMS")) {
      count = file.particle_count(value("the number of atoms"));
    } else if (line.starts_with("ITEM: BOX BOUNDS")) {
      x = read_bounds(file, line, words), y = read_bounds(file, line, words);
      file.require(line, "the bounds of the box in z");
      if (std::fabs(x.length - y.length) > 1e-9 * x.length) file.refuse("the box is not a square in x and y");
      frame.box_length = x.length;
    } else if (line.starts_with("ITEM: ATOMS")) {
      break;
    } else {
      file.refuse("this line belongs to no part of a LAMMPS dump");
    }
  }
  if (count == 0 || frame.box_length == 0) file.refuse("NUMBER OF ATOMS and BOX BOUNDS must come before ATOMS");
  split(line, words);
  const Columns columns(words, file);
  frame.unwrapped = columns.unwrapped();
  for (std::size_t i = 0; i < count; ++i) {
    file.require(line, "the last atom of a frame");
    split(line, words);
    if (words.size() < columns.count())
      file.refuse(fmt::format("{} columns where ITEM: ATOMS promises {}", words.size(), columns.count()));
    columns.read(words, file, x, y, frame);
  }
  return true;
}

}  // namespace

RawFrames open_lammps(const std::filesystem::path& path) {
  auto file = std::make_shared<TextFile>(path);
  return [file](RawFrame& frame) { return read_frame(*file, frame); };
}

}  // namespace sandglass
