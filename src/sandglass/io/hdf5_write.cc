#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/hdf5_library.h"

namespace sandglass {

using namespace hdf5;

namespace {

constexpr std::size_t greatest_file = std::size_t{1} << 50;

[[noreturn]] void fail_to_write(const std::filesystem::path& path, const std::string& object) {
  throw RunError(
      fmt::format("cannot write {}{}: is the disk full?", path.string(), object.empty() ? "" : ", " + object));
}

int descriptor_of(hid_t file) {
  void* descriptor = nullptr;
  return H5Fget_vfd_handle(file, H5P_DEFAULT, &descriptor) < 0 ? -1 : *static_cast<int*>(descriptor);
}

/// Ample room for what describes one more object and the groups on its way.
constexpr std::size_t description_bytes = 65536;

/// Takes disk space for the first `bytes` of a file without changing its size; the error code, or 0.
int take_room(int descriptor, std::size_t bytes) {
  if (::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0) return 0;
  // Not every file system can; a full disk is then found out by the write.
  return errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;
}

/// Closes a file that is given up. The library must not try to write what is left of it to a full disk: that goes to a
/// file in memory instead.
void abandon(hid_t file) {
  const int sink = memfd_create("abandoned", MFD_CLOEXEC), descriptor = descriptor_of(file);
  if (sink >= 0 && descriptor >= 0) dup2(sink, descriptor);
  ::close(sink);
  H5Fclose(file);
}

template <class T>
hid_t stored_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_STD_U64LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_STD_U8LE;
}

/// Creates a contiguous dataset without time stamps, so that equal data make equal files.
Handle make_dataset(hid_t file, const std::string& object, hid_t type, const Shape& shape, hid_t creation) {
  H5Pset_obj_track_times(creation, false);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle space = make_space(shape);
  return {H5Dcreate2(file, object.c_str(), type, space, links, creation, H5P_DEFAULT), H5Dclose};
}

Handle fixed_text_type(std::size_t length) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(1, length));  // the library knows no empty strings
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path, std::size_t user_block) {
  start_library();
  // Made by hand first: the system says clearly what is wrong, and the library finds room for its first block.
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) fail_to_write(path, errno);
  const int code = take_room(descriptor, description_bytes);
  ::close(descriptor);
  if (code != 0) fail_to_write(path, code);
  const Handle access = make_access();
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(creation, user_block);
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
  if (id < 0) fail_to_write(path, "");
  return {path, id, true};
}

Hdf5File Hdf5File::open_to_write(const std::filesystem::path& path) {
  start_library();
  const Handle access = make_access();
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(path, error);
  const hid_t id = is_file ? H5Fopen(path.c_str(), H5F_ACC_RDWR, access) : H5I_INVALID_HID;
  if (id < 0)
    throw RunError(fmt::format("cannot open {} to write into it: it was removed, damaged or protected", path.string()));
  return {path, id, true};
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : path_(std::move(other.path_)), id_(std::exchange(other.id_, -1)), writing_(other.writing_) {}

Hdf5File::~Hdf5File() {
  if (id_ >= 0) writing_ ? abandon(id_) : static_cast<void>(H5Fclose(id_));
}

void Hdf5File::close() {
  if (H5Fflush(id_, H5F_SCOPE_LOCAL) < 0) fail_to_write(path_, "");  // the destructor cleans up
  if (H5Fclose(std::exchange(id_, -1)) < 0) fail_to_write(path_, "");
  std::error_code error;  // gives back what room was left; no harm if it cannot
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_, error), error);
}

/// The library does not survive a failed write of its own bookkeeping: disk space is taken before it is needed.
void Hdf5File::make_room(std::size_t bytes) {
  hsize_t size = 0;
  H5Fget_filesize(id_, &size);
  if (const int code = take_room(descriptor_of(id_), size + bytes + description_bytes); code != 0) {
    fail_to_write(path_, code);
  }
}

template <class T>
void Hdf5File::write(const std::string& object, const Shape& shape, std::span<const T> values) {
  if (elements(shape) != values.size()) throw std::logic_error(object + ": the shape does not fit the values");
  make_room(values.size_bytes());
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Handle dataset = make_dataset(id_, object, stored_type<T>(), shape, creation);
  if (dataset < 0) fail_to_write(path_, object);
  if (values.empty()) return;
  if (H5Dwrite(dataset, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail_to_write(path_, object);
}

void Hdf5File::write_text(const std::string& object, const std::string& text) {
  make_room(text.size());
  const Handle type = fixed_text_type(text.size());
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Handle dataset = make_dataset(id_, object, type, {}, creation);
  if (dataset < 0 || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) < 0) {
    fail_to_write(path_, object);
  }
}

template <class T>
void Hdf5File::reserve(const std::string& object, const Shape& shape, T fill) {
  std::size_t bytes = 0;
  if (__builtin_mul_overflow(elements(shape), sizeof(T), &bytes) || bytes > greatest_file) fail_to_write(path_, object);
  make_room(bytes);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
  // Zeros come for free from the file system: only other values are written out.
  if (fill != T{}) H5Pset_fill_value(creation, memory_type<T>(), &fill);
  if (make_dataset(id_, object, stored_type<T>(), shape, creation) < 0) fail_to_write(path_, object);
}

template <class T>
void Hdf5File::write_row(const std::string& object, std::size_t row, std::span<const T> values) {
  const Opened opened = open_dataset(path_, id_, object);
  const Handle memory = select_row(path_, object, opened, row);
  check_shape(path_, object, {elements({opened.shape.begin() + 1, opened.shape.end()})}, {values.size()});
  if (H5Dwrite(opened.dataset, memory_type<T>(), memory, opened.space, H5P_DEFAULT, values.data()) < 0) {
    fail_to_write(path_, object);
  }
}

void Hdf5File::link(const std::string& existing, const std::string& object) {
  make_room(0);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  if (H5Lcreate_hard(id_, existing.c_str(), id_, object.c_str(), links, H5P_DEFAULT) < 0) fail_to_write(path_, object);
}

namespace {

/// Writes one attribute; a group that does not exist yet is made.
void write_attribute(hid_t file, const std::filesystem::path& path, const std::string& object, const std::string& name,
                     hid_t type, hid_t space, hid_t memory, const void* values) {
  if (object != "/" && H5Lexists(file, object.c_str(), H5P_DEFAULT) <= 0) {
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    const Handle group(H5Gcreate2(file, object.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  }
  const Handle attribute(
      H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (attribute < 0 || H5Awrite(attribute, memory, values) < 0) fail_to_write(path, object + ", attribute " + name);
}

}  // namespace

template <class T>
void Hdf5File::set_attribute(const std::string& object, const std::string& name, std::span<const T> values) {
  make_room(values.size_bytes());
  const Handle space = make_space(values.size() == 1 ? Shape{} : Shape{values.size()});
  write_attribute(id_, path_, object, name, stored_type<T>(), space, memory_type<T>(), values.data());
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name,
                             const std::vector<std::string>& values) {
  std::size_t longest = 0;
  for (const std::string& value : values) longest = std::max(longest, value.size());
  std::string packed;
  for (const std::string& value : values) packed += value + std::string(longest - value.size(), '\0');
  make_room(packed.size());
  const Handle type = fixed_text_type(longest);
  const Handle space = make_space({values.size()});
  write_attribute(id_, path_, object, name, type, space, type, packed.data());
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, const std::string& value) {
  make_room(value.size());
  const Handle type = fixed_text_type(value.size());
  const Handle space = make_space({});
  write_attribute(id_, path_, object, name, type, space, type, value.c_str());
}

#define SANDGLASS_HDF5_TYPE(T)                                                               \
  template void Hdf5File::write<T>(const std::string&, const Shape&, std::span<const T>);    \
  template void Hdf5File::reserve<T>(const std::string&, const Shape&, T);                   \
  template void Hdf5File::write_row<T>(const std::string&, std::size_t, std::span<const T>); \
  template void Hdf5File::set_attribute<T>(const std::string&, const std::string&, std::span<const T>);
SANDGLASS_HDF5_TYPE(double)
SANDGLASS_HDF5_TYPE(std::uint64_t)
SANDGLASS_HDF5_TYPE(std::int64_t)
SANDGLASS_HDF5_TYPE(std::int32_t)
SANDGLASS_HDF5_TYPE(std::uint8_t)
#undef SANDGLASS_HDF5_TYPE

}  // namespace sandglass
