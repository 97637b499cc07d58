// HDF5 files, as little of them as the program needs: datasets and attributes by path, checked on reading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sandglass {

using Shape = std::vector<std::size_t>;

/// An open file; closed when it goes. Objects are named by absolute path; groups are made on the way. Element types are
/// double, std::uint64_t, std::int64_t, std::int32_t and std::uint8_t, stored little-endian. No message of the library
/// reaches the terminal: failures to write are RunErrors, everything wrong with a file that is read is an InputError
/// naming file and object. Nothing is allocated before type and shape are known to be sane, no other file is opened
/// (external links and data, virtual datasets), and integers that do not fit are refused, not clipped.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path, std::size_t user_block = 0);
  static Hdf5File open(const std::filesystem::path& path);           ///< to read
  static Hdf5File open_to_write(const std::filesystem::path& path);  ///< into datasets that exist
  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;
  ~Hdf5File();

  /// Flushes and closes a file that was written; without it, what was written is given up. Throws RunError.
  void close();

  // Writing. An empty shape is a scalar.
  template <class T>
  void write(const std::string& object, const Shape& shape, std::span<const T> values);
  void write_text(const std::string& object, const std::string& text);
  /// A dataset whose room is allocated now and whose elements are `fill` until written (row by row).
  template <class T>
  void reserve(const std::string& object, const Shape& shape, T fill);
  template <class T>
  void write_row(const std::string& object, std::size_t row, std::span<const T> values);
  void link(const std::string& existing, const std::string& object);  ///< a second name of an object
  template <class T>
  void set_attribute(const std::string& object, const std::string& name, std::span<const T> values);
  void set_attribute(const std::string& object, const std::string& name, const std::vector<std::string>& values);
  void set_attribute(const std::string& object, const std::string& name, const std::string& value);

  // Reading.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] bool has(const std::string& object) const;
  [[nodiscard]] Shape shape(const std::string& object) const;
  template <class T>
  [[nodiscard]] std::vector<T> read(const std::string& object, const Shape& expected) const;
  template <class T>
  [[nodiscard]] std::vector<T> read_row(const std::string& object, std::size_t row, const Shape& expected) const;
  [[nodiscard]] std::string read_text(const std::string& object, std::size_t limit) const;
  [[nodiscard]] std::string text_attribute(const std::string& object, const std::string& name) const;

 private:
  Hdf5File(std::filesystem::path path, std::int64_t id, bool writing)
      : path_(std::move(path)), id_(id), writing_(writing) {}
  void make_room(std::size_t bytes);

  std::filesystem::path path_;
  std::int64_t id_ = -1;
  bool writing_ = false;
};

}  // namespace sandglass
