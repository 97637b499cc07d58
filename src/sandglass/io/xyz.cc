#include "sandglass/io/xyz.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <utility>

#include "sandglass/io/text_file.h"

namespace sandglass {
namespace {

using Words = std::vector<std::string_view>;

/// The key=value pairs of a comment line; values may be quoted. Keys in lower case.
std::vector<std::pair<std::string, std::string>> pairs_of(std::string_view line) {
  std::vector<std::pair<std::string, std::string>> pairs;
  std::size_t at = 0;
  const auto until = [&](auto&& stops) {
    const std::size_t begin = at;
    while (at < line.size() && !stops(line[at])) ++at;
    return std::string(line.substr(begin, at - begin));
  };
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (at < line.size()) {
    until([&](char c) { return !blank(c); });
    std::string key = until([&](char c) { return blank(c) || c == '='; });
    for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::string value;
    if (at < line.size() && line[at] == '=') {
      ++at;
      if (at < line.size() && (line[at] == '"' || line[at] == '\'')) {
        const char quote = line[at++];
        value = until([&](char c) { return c == quote; });
        ++at;
      } else {
        value = until(blank);
      }
    }
    if (!key.empty()) pairs.emplace_back(std::move(key), std::move(value));
  }
  return pairs;
}

/// Where the columns of a quantity begin; -1: there are none.
struct Columns {
  int kind = -1, position = -1, velocity = -1, id = -1, radius = -1, diameter = -1, mass = -1, image = -1;
  int count = 0;
};

Columns columns_of(const std::string& properties, const TextFile& file) {
  Words parts;
  std::string spaced = properties;
  std::replace(spaced.begin(), spaced.end(), ':', ' ');
  split(spaced, parts);
  Columns columns;
  if (parts.size() % 3 != 0) file.refuse("Properties must be triples name:type:columns");
  for (std::size_t i = 0; i < parts.size(); i += 3) {
    const std::string_view name = parts[i];
    const std::int64_t width = file.whole_number(parts[i + 2]);
    if (width < 1 || width > 64) file.refuse(fmt::format("a property of {} columns is impossible", width));
    const bool plane = width == 2 || width == 3;
    if (name == "species" || name == "type") columns.kind = columns.count;
    if (name == "pos" && plane) columns.position = columns.count;
    if ((name == "velo" || name == "vel" || name == "velocity" || name == "velocities") && plane)
      columns.velocity = columns.count;
    if (name == "id") columns.id = columns.count;
    if (name == "radius") columns.radius = columns.count;
    if (name == "diameter") columns.diameter = columns.count;
    if (name == "mass" || name == "masses") columns.mass = columns.count;
    if (name == "image" && plane) columns.image = columns.count;
    columns.count += static_cast<int>(width);
  }
  if (columns.position < 0) file.refuse("Properties has no pos:R:2 or pos:R:3: there are no positions to read");
  return columns;
}

double square_side(const std::string& lattice, const TextFile& file) {
  Words words;
  split(lattice, words);
  if (words.size() != 9) file.refuse("Lattice must have nine numbers");
  double cell[9];
  for (std::size_t i = 0; i < 9; ++i) cell[i] = file.number(words[i]);
  const bool square = cell[0] > 0 && std::fabs(cell[0] - cell[4]) <= 1e-9 * cell[0] && cell[1] == 0 && cell[2] == 0 &&
                      cell[3] == 0 && cell[5] == 0;
  if (!square) file.refuse("the box is not a square: Lattice must be \"L 0 0 0 L 0 0 0 c\"");
  return cell[0];
}

void read_particle(const Words& words, const Columns& columns, const TextFile& file, RawFrame& frame) {
  const auto word = [&](int column) { return words[static_cast<std::size_t>(column)]; };
  const auto number = [&](int column) { return file.number(word(column)); };
  frame.x.push_back(number(columns.position));
  frame.y.push_back(number(columns.position + 1));
  if (columns.velocity >= 0) {
    frame.vx.push_back(number(columns.velocity));
    frame.vy.push_back(number(columns.velocity + 1));
  }
  if (columns.image >= 0) {
    frame.image_x.push_back(file.whole_number(word(columns.image)));
    frame.image_y.push_back(file.whole_number(word(columns.image + 1)));
  }
  if (columns.kind >= 0) frame.kind.emplace_back(word(columns.kind));
  if (columns.id >= 0) frame.id.push_back(file.whole_number(word(columns.id)));
  if (columns.radius >= 0) frame.radius.push_back(number(columns.radius));
  if (columns.radius < 0 && columns.diameter >= 0) frame.radius.push_back(number(columns.diameter) / 2);
  if (columns.mass >= 0) frame.mass.push_back(number(columns.mass));
}

bool read_frame(TextFile& file, RawFrame& frame) {
  frame = {};
  std::string line;
  Words words;
  do {
    if (!file.next(line)) return false;
    split(line, words);
  } while (words.empty());
  if (words.size() != 1) file.refuse("a frame of an XYZ file begins with the number of its particles alone");
  const std::size_t count = file.particle_count(words[0]);
  file.require(line, "the comment line of a frame");
  std::string properties = "species:S:1:pos:R:3";
  bool has_box = false;
  for (const auto& [key, value] : pairs_of(line)) {
    if (key == "properties") properties = value;
    if (key == "lattice") frame.box_length = square_side(value, file), has_box = true;
    if (key == "time") frame.time = file.number(value), frame.has_time = true;
    if (key == "step") frame.step = file.whole_number(value);
  }
  if (!has_box) file.refuse("there is no Lattice=\"...\": the side of the periodic box must be known");
  const Columns columns = columns_of(properties, file);
  for (std::size_t i = 0; i < count; ++i) {
    file.require(line, "the last particle of a frame");
    split(line, words);
    if (words.size() < static_cast<std::size_t>(columns.count))
      file.refuse(fmt::format("{} columns where Properties promises {}", words.size(), columns.count));
    read_particle(words, columns, file, frame);
  }
  return true;
}

}  // namespace

RawFrames open_xyz(const std::filesystem::path& path) {
  auto file = std::make_shared<TextFile>(path);
  return [file](RawFrame& frame) { return read_frame(*file, frame); };
}

}  // namespace sandglass
