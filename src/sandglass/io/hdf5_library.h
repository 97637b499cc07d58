// What reading and writing HDF5 share; for the .cc files of hdf5.h alone, since it brings in the library.
#pragma once

#include <hdf5.h>

#include <type_traits>
#include <utility>

#include "sandglass/io/hdf5.h"

namespace sandglass::hdf5 {

static_assert(std::is_same_v<hid_t, std::int64_t>);

/// An identifier of the library with the function that gives it back.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: stands for the identifier in calls of the library

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Silences the library's own messages, once.
void start_library();

/// How files are opened.
Handle make_access();

template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

Handle make_space(const Shape& shape);

/// The product of the sizes; the greatest number if it is too large.
std::size_t elements(const Shape& shape);

/// An open dataset and the shape that it claims.
struct Opened {
  Handle dataset, space;
  Shape shape;
};

Opened open_dataset(const std::filesystem::path& path, hid_t file, const std::string& object);

/// Selects row `row` of a dataset; the memory space that fits it.
Handle select_row(const std::filesystem::path& path, const std::string& object, const Opened& opened, std::size_t row);

[[noreturn]] void fail_to_read(const std::filesystem::path& path, const std::string& object, const std::string& why);
void check_shape(const std::filesystem::path& path, const std::string& object, const Shape& found,
                 const Shape& expected);

}  // namespace sandglass::hdf5
