#include "sandglass/io/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <type_traits>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/state_file.h"

namespace sandglass {
namespace {

constexpr std::size_t longest_config = 1 << 20;

std::vector<std::uint64_t> halves(const std::vector<ExactSum>& sums) {
  std::vector<std::uint64_t> packed;
  packed.reserve(2 * sums.size());
  for (const ExactSum& sum : sums) {
    packed.push_back(static_cast<std::uint64_t>(sum.high()));
    packed.push_back(sum.low());
  }
  return packed;
}

void write_field(Hdf5File& file, const std::string& object, const double* value) {
  file.write(object, {}, std::span(value, 1));
}
void write_field(Hdf5File& file, const std::string& object, const std::uint64_t* value) {
  file.write(object, {}, std::span(value, 1));
}
template <class T>
void write_field(Hdf5File& file, const std::string& object, const std::vector<T>* values) {
  if constexpr (std::is_same_v<T, ExactSum>) {
    const auto packed = halves(*values);
    file.write(object, {values->size(), 2}, std::span<const std::uint64_t>(packed));
  } else {
    file.write(object, {values->size()}, std::span<const T>(*values));
  }
}

/// The shape that the file must have: that of the target, or of the file where the target is still empty (the reader
/// bounds it by the size of the file).
Shape expected_shape(const Hdf5File& file, const std::string& object, std::size_t allocated, std::size_t rank) {
  Shape shape = file.shape(object);
  if (shape.size() != rank || (allocated > 0 && shape[0] != allocated)) {
    throw InputError(fmt::format("{}, {} does not fit this run: it was written with another configuration",
                                 file.path().string(), object));
  }
  return shape;
}

template <class T>
void read_field(const Hdf5File& file, const std::string& object, T* value) {
  *value = file.read<T>(object, {})[0];
}
template <class T>
void read_field(const Hdf5File& file, const std::string& object, std::vector<T>* values) {
  if constexpr (std::is_same_v<T, ExactSum>) {
    Shape shape = expected_shape(file, object, values->size(), 2);
    shape[1] = 2;
    const auto packed = file.read<std::uint64_t>(object, shape);
    values->resize(shape[0]);
    for (std::size_t i = 0; i < shape[0]; ++i) {
      (*values)[i] = ExactSum::from_halves(static_cast<std::int64_t>(packed[2 * i]), packed[2 * i + 1]);
    }
  } else {
    *values = file.read<T>(object, expected_shape(file, object, values->size(), 1));
  }
}

std::string object_of(const FieldGroup& group, const Field& field) {
  return "/fields/" + group.first + "/" + field.name;
}

void restore(const Hdf5File& file, const std::vector<FieldGroup>& groups) {
  for (const FieldGroup& group : groups) {
    for (const Field& field : group.second) {
      std::visit([&](auto* target) { read_field(file, object_of(group, field), target); }, field.target);
    }
  }
}

/// The file to go on from: the newest that is whole.
std::filesystem::path choose(const std::filesystem::path& path) {
  try {
    check_seal(path);
    return path;
  } catch (const InputError& newest) {
    const std::filesystem::path previous = previous_checkpoint(path);
    if (!std::filesystem::exists(previous)) throw;
    try {
      check_seal(previous);
    } catch (const InputError& older) {
      throw InputError(
          fmt::format("no checkpoint can be used: {}; {}; start again with --force", newest.what(), older.what()));
    }
    return previous;
  }
}

}  // namespace

std::filesystem::path previous_checkpoint(const std::filesystem::path& path) {
  std::filesystem::path previous = path;
  return previous.replace_extension(".previous" + path.extension().string());
}

bool has_checkpoint(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(path, error) || std::filesystem::exists(previous_checkpoint(path), error);
}

void write_checkpoint(const std::filesystem::path& path, const State& state, const std::string& config_toml,
                      const std::vector<FieldGroup>& groups) {
  const auto write = [&](const std::filesystem::path& temporary) {
    Hdf5File file = Hdf5File::create(temporary, seal_size);
    write_state(file, state);
    file.write_text("/config", config_toml);
    for (const FieldGroup& group : groups) {
      for (const Field& field : group.second) {
        std::visit([&](const auto* target) { write_field(file, object_of(group, field), target); }, field.target);
      }
    }
    file.close();
    seal_file(temporary);
  };
  const auto keep_previous = [&] {
    std::error_code error;
    std::filesystem::rename(path, previous_checkpoint(path), error);  // there is none at first
  };
  replace_file(path, write, keep_previous);
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const std::vector<FieldGroup>& groups) {
  const std::filesystem::path chosen = choose(path);
  const Hdf5File file = Hdf5File::open(chosen);
  Checkpoint checkpoint{read_state(file), file.read_text("/config", longest_config), chosen != path, chosen};
  restore(file, groups);
  return checkpoint;
}

void restore_fields(const Checkpoint& checkpoint, const std::vector<FieldGroup>& groups) {
  restore(Hdf5File::open(checkpoint.file), groups);
}

}  // namespace sandglass
