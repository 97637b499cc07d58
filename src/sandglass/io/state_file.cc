#include "sandglass/io/state_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>

#include "sandglass/core/errors.h"
#include "sandglass/io/apart.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/state_check.h"
#include "sandglass/io/trajectory.h"

namespace sandglass {
namespace {

const std::string format_name = "sandglass state";
const std::string format_version = "1";

/// The one list of everything but the disks; writing and reading walk it.
template <class S, class Visit>
void visit_scalars(S& state, Visit&& visit) {
  visit("box_length", state.box_length);
  visit("mixture/radius", state.mixture.radius);
  visit("mixture/mass", state.mixture.mass);
  visit("collision/restitution", state.collision.restitution);
  visit("collision/collapse", state.collision.collapse);
  visit("collision/collapse_time", state.collision.collapse_time);
  visit("drive/kind", state.drive.kind);
  visit("drive/partner", state.drive.partner);
  visit("drive/reach", state.drive.reach);
  visit("drive/frequency", state.drive.frequency);
  visit("drive/amplitude", state.drive.amplitude);
  visit("seed", state.seed);
  visit("epoch_length", state.epoch_length);
  visit("epoch", state.epoch);
  visit("now", state.now);
  visit("tally/contacts", state.tally.contacts);
  visit("tally/elastic_contacts", state.tally.elastic_contacts);
  visit("tally/kicked", state.tally.kicked);
  visit("tally/kicks", state.tally.kicks);
  visit("tally/kicks_without_partner", state.tally.kicks_without_partner);
  visit("tally/transits", state.tally.transits);
  visit("tally/virial", state.tally.virial);
  visit("tally/dissipated", state.tally.dissipated);
  visit("tally/injected", state.tally.injected);
}

/// The one list of the columns of the disks.
template <class Visit>
void visit_columns(Visit&& visit) {
  visit("x", &Disk::x);
  visit("y", &Disk::y);
  visit("vx", &Disk::vx);
  visit("vy", &Disk::vy);
  visit("time", &Disk::time);
  visit("last_contact", &Disk::last_contact);
  visit("next_kick", &Disk::next_kick);
  visit("kick_count", &Disk::kick_count);
  visit("image_x", &Disk::image_x);
  visit("image_y", &Disk::image_y);
  visit("species", &Disk::species);
}

/// How a type is stored: an enumeration as the byte it is, an exact sum as its two halves, all else as itself.
template <class T>
struct Stored {
  using Element = std::conditional_t<std::is_enum_v<T>, std::uint8_t, T>;
  static Shape shape() { return {}; }
  static std::vector<Element> pack(const T& value) { return {static_cast<Element>(value)}; }
  static T unpack(const std::vector<Element>& values) { return static_cast<T>(values[0]); }
};
template <class T, std::size_t n>
struct Stored<std::array<T, n>> {
  using Element = T;
  static Shape shape() { return {n}; }
  static std::vector<T> pack(const std::array<T, n>& value) { return {value.begin(), value.end()}; }
  static std::array<T, n> unpack(const std::vector<T>& values) {
    std::array<T, n> value{};
    std::copy_n(values.begin(), n, value.begin());
    return value;
  }
};
template <>
struct Stored<ExactSum> {
  using Element = std::uint64_t;
  static Shape shape() { return {2}; }
  static std::vector<Element> pack(const ExactSum& sum) { return {static_cast<std::uint64_t>(sum.high()), sum.low()}; }
  static ExactSum unpack(const std::vector<Element>& v) {
    return ExactSum::from_halves(static_cast<std::int64_t>(v[0]), v[1]);
  }
};

template <class Member>
struct MemberType;
template <class T>
struct MemberType<T Disk::*> {
  using Type = T;
};

}  // namespace

void write_state(Hdf5File& file, const State& state) {
  visit_scalars(state, [&]<class T>(const char* name, const T& value) {
    const auto packed = Stored<T>::pack(value);
    file.write("/state/" + std::string(name), Stored<T>::shape(), std::span(packed));
  });
  visit_columns([&](const char* name, auto member) {
    using Element = typename Stored<typename MemberType<decltype(member)>::Type>::Element;
    std::vector<Element> column;
    column.reserve(state.size());
    for (const Disk& disk : state.disks) column.push_back(static_cast<Element>(disk.*member));
    file.write("/state/disks/" + std::string(name), {state.size()}, std::span<const Element>(column));
  });
  file.set_attribute("/state", "format", format_name);
  file.set_attribute("/state", "format_version", format_version);
}

State read_state(const Hdf5File& file) {
  if (file.text_attribute("/state", "format") != format_name ||
      file.text_attribute("/state", "format_version") != format_version) {
    throw InputError(fmt::format("{} was written by another version of this program", file.path().string()));
  }
  State state;
  visit_scalars(state, [&]<class T>(const char* name, T& value) {
    using Element = typename Stored<T>::Element;
    value = Stored<T>::unpack(file.read<Element>("/state/" + std::string(name), Stored<T>::shape()));
  });
  const Shape shape = file.shape("/state/disks/x");
  if (shape.size() != 1 || shape[0] > most_disks) {
    throw InputError(fmt::format("{} holds no list of at most {} disks", file.path().string(), most_disks));
  }
  visit_columns([&](const char* name, auto member) {
    using Type = typename MemberType<decltype(member)>::Type;
    const auto column = file.read<typename Stored<Type>::Element>("/state/disks/" + std::string(name), shape);
    state.disks.resize(column.size());
    for (std::size_t id = 0; id < column.size(); ++id) state.disks[id].*member = static_cast<Type>(column[id]);
  });
  check_state(state, file.path().string());
  return state;
}

void write_state(const std::filesystem::path& path, const State& state) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    Hdf5File file = Hdf5File::create(temporary, seal_size);
    write_state(file, state);
    file.close();
    seal_file(temporary);
  });
}

State read_state(const std::filesystem::path& path) {
  check_seal(path);
  return read_state(Hdf5File::open(path));
}

State read_start_file(const std::filesystem::path& path) {
  if (has_seal(path)) return read_state(path);
  return read_apart(path, [&] { return read_last_frame(path); });
}

}  // namespace sandglass
