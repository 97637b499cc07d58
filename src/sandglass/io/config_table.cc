#include "sandglass/io/config_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

constexpr std::size_t most_wavenumbers = 32;

std::string describe(const Range& range) {
  if (range.low == -Range::infinity && range.high == Range::infinity) return "";
  if (range.high == Range::infinity) return fmt::format("{} {}", range.open ? ">" : ">=", range.low);
  return fmt::format("{}{}, {}]", range.open ? '(' : '[', range.low, range.high);
}

std::string quoted_words(const Key& key) {
  std::string text;
  for (const auto word : key.words) text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", word);
  return text;
}

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

[[noreturn]] void wrong_type(const Key& key, const Given& given, const std::string& wanted) {
  std::string got = type_name(given.node);
  if (const auto* text = given.node.as_string()) got += fmt::format(" (\"{}\")", text->get());
  throw InputError(fmt::format("{}: {} must be {}, not {}", given.place, key.name, wanted, got));
}

double number(const Key& key, const Given& given, const toml::node& node, const std::string& wanted) {
  double value = 0;
  if (const auto* whole = node.as_integer()) {
    value = static_cast<double>(whole->get());
  } else if (const auto* real = node.as_floating_point()) {
    value = real->get();
  } else {
    wrong_type(key, given, wanted);
  }
  const Range& range = key.range;
  const bool inside =
      std::isfinite(value) && value <= range.high && (range.open ? value > range.low : value >= range.low);
  if (!inside) {
    throw InputError(fmt::format("{}: {} = {} is out of range: it must be {} {}", given.place, key.name, value,
                                 range.high == Range::infinity ? "finite and" : "in", describe(range)));
  }
  return value;
}

// Reading, by type of the member.

void read_value(const Key& key, const Given& given, std::uint64_t& target) {
  const double value = number(key, given, given.node, "an integer");
  if (const auto* whole = given.node.as_integer()) {
    target = static_cast<std::uint64_t>(whole->get());
    return;
  }
  if (value != std::floor(value)) {
    throw InputError(fmt::format("{}: {} = {} must be a whole number", given.place, key.name, value));
  }
  constexpr double largest_exact = 0x1p53;  // beyond it a floating-point literal may not mean what it says
  if (value > largest_exact) {
    throw InputError(
        fmt::format("{}: {} = {} is too large for a number with a point or an exponent: write all its digits",
                    given.place, key.name, value));
  }
  target = static_cast<std::uint64_t>(value);
}

void read_value(const Key& key, const Given& given, double& target) {
  target = number(key, given, given.node, "a number");
}

void read_value(const Key& key, const Given& given, std::optional<double>& target) {
  const auto* word = given.node.as_string();
  if (word != nullptr && word->get() == key.words.front()) {
    target.reset();
  } else {
    target = number(key, given, given.node, fmt::format("\"{}\" or a number", key.words.front()));
  }
}

void read_value(const Key& key, const Given& given, std::vector<double>& target) {
  const auto* list = given.node.as_array();
  if (list == nullptr) wrong_type(key, given, "an array of numbers");
  if (list->empty() || list->size() > most_wavenumbers) {
    throw InputError(
        fmt::format("{}: {} must have 1 to {} values, not {}", given.place, key.name, most_wavenumbers, list->size()));
  }
  target.clear();
  for (const toml::node& element : *list) target.push_back(number(key, given, element, "an array of numbers"));
}

/// A path; it stays valid wherever the complete configuration is written.
void read_value(const Key& key, const Given& given, std::string& target) {
  const auto* text = given.node.as_string();
  if (text == nullptr && given.raw.empty()) wrong_type(key, given, "a string");
  target = text != nullptr ? text->get() : given.raw;
  if (target.find('\0') != std::string::npos) {
    throw InputError(fmt::format("{}: {} contains a null character", given.place, key.name));
  }
  if (!target.empty()) target = std::filesystem::absolute(given.folder / target).lexically_normal().string();
}

template <class T>
requires std::is_enum_v<T>
void read_value(const Key& key, const Given& given, T& target) {
  const auto* text = given.node.as_string();
  if (text == nullptr) wrong_type(key, given, fmt::format("one of {}", quoted_words(key)));
  const auto word = std::find(key.words.begin(), key.words.end(), text->get());
  if (word == key.words.end()) {
    throw InputError(fmt::format("{}: {} = \"{}\" is unknown: it must be one of {}", given.place, key.name, text->get(),
                                 quoted_words(key)));
  }
  target = static_cast<T>(word - key.words.begin());
}

// Writing, by type of the member; what is written reads back to the same bits.

std::string write_value(const Key&, std::uint64_t value) { return fmt::format("{}", value); }
std::string write_value(const Key&, double value) { return fmt::format("{}", value); }
std::string write_value(const Key&, const std::string& value) { return toml_quote(value); }
std::string write_value(const Key&, const std::vector<double>& value) {
  return fmt::format("[{}]", fmt::join(value, ", "));
}
std::string write_value(const Key& key, const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : toml_quote(key.words.front());
}
template <class T>
requires std::is_enum_v<T> std::string write_value(const Key& key, T value) {
  return toml_quote(key.words.at(static_cast<std::size_t>(value)));
}

template <class T>
constexpr std::string_view type_of() {
  if constexpr (std::is_enum_v<T>) return "name";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "integer";
  if constexpr (std::is_same_v<T, double>) return "number";
  if constexpr (std::is_same_v<T, std::optional<double>>) return "number or name";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "array of numbers";
  if constexpr (std::is_same_v<T, std::string>) return "path";
}

/// Ties a row of the table to the member it stands for.
template <auto section, auto member>
Key key(Key row) {
  using Section = std::remove_reference_t<decltype(std::declval<Config&>().*section)>;
  row.type = type_of<std::remove_reference_t<decltype(std::declval<Section&>().*member)>>();
  row.read = [](Config& config, const Key& self, const Given& given) {
    read_value(self, given, (config.*section).*member);
  };
  row.write = [](const Config& config, const Key& self) { return write_value(self, (config.*section).*member); };
  return row;
}

}  // namespace

const std::vector<Key>& config_table() {
  using C = Config;
  static const std::vector<Key> keys{
      key<&C::system, &C::System::particles>({.name = "system.particles",
                                              .description = "Number of disks N; `big_fraction` of them must be whole.",
                                              .range = {2, 0x1p31}}),
      key<&C::system, &C::System::packing_fraction>(
          {.name = "system.packing_fraction",
           .description = "Area fraction eta. The method `insert` reaches 0.45, `quench` 0.01 to 0.82.",
           .range = {1e-4, 0.82}}),
      key<&C::system, &C::System::size_ratio>(
          {.name = "system.size_ratio", .description = "R_b / R_s; the masses are as the areas.", .range = {1, 10}}),
      key<&C::system, &C::System::big_fraction>(
          {.name = "system.big_fraction", .description = "Fraction of the disks that are big.", .range = {0, 1}}),
      key<&C::collision, &C::Collision::restitution>(
          {.name = "collision.restitution",
           .description =
               "Normal restitution eps: the approach velocity is reversed and multiplied by it. 1 is elastic.",
           .range = {0, 1, true}}),
      key<&C::collision, &C::Collision::collapse_policy>(
          {.name = "collision.collapse_policy",
           .description = "What prevents the inelastic collapse: `tc` makes a collision elastic when either disk has "
                          "collided less than `collapse_time` ago.",
           .words = {"none", "tc"}}),
      key<&C::collision, &C::Collision::collapse_time>({.name = "collision.collapse_time",
                                                        .unit = "mean free times",
                                                        .description = "t_c of the TC model; the mean free time is "
                                                                       "that of the formula (Enskog).",
                                                        .range = {0, 1}}),
      key<&C::drive, &C::DriveKeys::kind>(
          {.name = "drive.kind",
           .description = "`pair` kicks a disk and a neighbour by opposite momenta, `single` one disk alone, `none` "
                          "lets the system cool freely.",
           .words = {"none", "pair", "single"}}),
      key<&C::drive, &C::DriveKeys::partner>(
          {.name = "drive.partner",
           .description = "Second disk of a pair kick: `nearest` by surface gap, or a random one `within` reach.",
           .words = {"nearest", "within"}}),
      key<&C::drive, &C::DriveKeys::reach>(
          {.name = "drive.reach",
           .unit = "R_i + R_j",
           .description = "Greatest distance of the centres of a pair for the rule `within`.",
           .range = {1, 1000, true}}),
      key<&C::drive, &C::DriveKeys::frequency>(
          {.name = "drive.frequency",
           .unit = "1/time",
           .description = "Rate f_Dr at which a disk is kicked; `collision` makes it the collision rate.",
           .range = {0, 1e9, true},
           .words = {"collision"}}),
      key<&C::drive, &C::DriveKeys::temperature>(
          {.name = "drive.temperature",
           .unit = "energy",
           .description = "Temperature (mean kinetic energy per disk) of the start; the driving is calibrated to it.",
           .range = {1e-6, 1e6}}),
      key<&C::prepare, &C::Prepare::method>(
          {.name = "prepare.method",
           .description = "Start: `quench` compresses soft disks to `jammed_fraction` and expands, `insert` places "
                          "disks at random, `file` takes the positions of another run.",
           .words = {"quench", "insert", "file"}}),
      key<&C::prepare, &C::Prepare::jammed_fraction>(
          {.name = "prepare.jammed_fraction",
           .description = "Area fraction to which `quench` compresses; above `system.packing_fraction`.",
           .range = {0.5, 0.9}}),
      key<&C::prepare, &C::Prepare::file>(
          {.name = "prepare.file",
           .description = "State, checkpoint or trajectory to start from (method `file`). In a file relative to its "
                          "folder, on the command line to the working folder."}),
      key<&C::run, &C::Run::seed>(
          {.name = "run.seed", .description = "Seed of every random number of the run.", .range = {0, 0x1p63}}),
      key<&C::run, &C::Run::equilibrate>({.name = "run.equilibrate",
                                          .unit = "collisions per disk",
                                          .description = "Length of the run before it is measured.",
                                          .range = {0, 1e12}}),
      key<&C::run, &C::Run::collisions>({.name = "run.collisions",
                                         .unit = "collisions per disk",
                                         .description = "Length of the measured stretch.",
                                         .range = {0, 1e12, true}}),
      key<&C::run, &C::Run::intervals>(
          {.name = "run.intervals",
           .description = "Parts of the measured stretch whose averages give the standard errors; each is at least two "
                          "collisions per disk long.",
           .range = {1, 1e6}}),
      key<&C::run, &C::Run::threads>(
          {.name = "run.threads",
           .description =
               "Threads for one trajectory, at most; fewer where more do not pay. The results do not depend on it.",
           .range = {1, 1024},
           .physics = false}),
      key<&C::run, &C::Run::max_walltime_seconds>(
          {.name = "run.max_walltime_seconds",
           .unit = "s",
           .description = "Stop at a checkpoint after this wall-clock time, to be resumed (exit code 75); 0: never.",
           .range = {0, 1e9},
           .physics = false}),
      key<&C::run, &C::Run::self_check>(
          {.name = "run.self_check",
           .description = "Invariants of the running engine are `sampled` (under 1 % of the time), or `every_event` is "
                          "done a second time by the rule (slow: O(N) each).",
           .words = {"sampled", "every_event"},
           .physics = false}),
      key<&C::observe, &C::Observe::wavenumbers>(
          {.name = "observe.wavenumbers",
           .unit = "1/R_s",
           .description = "Wavenumbers k of the scattering functions, at most 32.",
           .range = {0, 1e4, true}}),
      key<&C::observe, &C::Observe::lags_per_decade>({.name = "observe.lags_per_decade",
                                                      .description = "Density of the time lags of correlations.",
                                                      .range = {1, 100}}),
      key<&C::observe, &C::Observe::overlap_length>(
          {.name = "observe.overlap_length",
           .unit = "R_s",
           .description = "How far a disk may have gone to count as overlapping with itself in Q(t) and chi_4(t).",
           .range = {0, 1e4, true}}),
      key<&C::observe, &C::Observe::selection_time>(
          {.name = "observe.selection_time",
           .unit = "time",
           .description = "Time over which the fastest and the slowest tenth of the disks are told apart, at most the "
                          "length of an interval; 0: that length.",
           .range = {0, 1e12}}),
      key<&C::observe, &C::Observe::exponent_from>(
          {.name = "observe.exponent_from",
           .unit = "time",
           .description = "Start of the range of lags over which the exponent of the MSD is fitted.",
           .range = {0, 1e12, true},
           .physics = false}),
      key<&C::observe, &C::Observe::exponent_to>({.name = "observe.exponent_to",
                                                  .unit = "time",
                                                  .description = "End of that range; the paper's is 1 to 10.",
                                                  .range = {0, 1e12, true},
                                                  .physics = false}),
      key<&C::observe, &C::Observe::structure_frames>(
          {.name = "observe.structure_frames",
           .description = "Frames, evenly spaced, of which g(r), S(k), bond order and velocity structure are taken; "
                          "`auto`: 5 to 20, one per 1500 collisions of a disk; 0: none.",
           .range = {0, 1e6},
           .words = {"auto"}}),
      key<&C::observe, &C::Observe::bin_width>(
          {.name = "observe.bin_width",
           .unit = "R_s",
           .description = "Width of the bins of g(r), 0.001 or more; 0: L / 800 as in the paper, at most 0.4.",
           .range = {0, 1e3}}),
      key<&C::output, &C::Output::trajectory_frames>(
          {.name = "output.trajectory_frames",
           .description =
               "Frames in trajectory.h5, evenly spaced with both ends included; 0: no file, else at least 2.",
           .range = {0, 1e6}}),
      key<&C::output, &C::Output::checkpoint_seconds>({.name = "output.checkpoint_seconds",
                                                       .unit = "s",
                                                       .description = "Wall-clock time between checkpoints.",
                                                       .range = {0, 1e9, true},
                                                       .physics = false}),
  };
  return keys;
}

std::string toml_quote(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += fmt::format("\\{}", c);
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04X}", code);
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string Key::allowed() const {
  const std::string numbers = describe(range);
  if (words.empty() || numbers.empty()) return words.empty() ? numbers : quoted_words(*this);
  return quoted_words(*this) + " or " + numbers;
}

}  // namespace sandglass
