#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/io/hdf5_library.h"

namespace sandglass {
namespace hdf5 {

void start_library() {
  static const bool started = [] {
    H5dont_atexit();  // its last clean-up crashes after a write that failed; files are closed by their owners
    H5open();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5Lunregister(H5L_TYPE_EXTERNAL);  // no file makes us open another one
    H5PLset_loading_state(0);          // or load the code of a filter
    return true;
  }();
  (void)started;
}

Handle make_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, false, true);  // a reader who looks at a file of a running simulation must not stop it
  H5Pset_sieve_buf_size(access, 0);          // small writes too reach the disk, or fail, where they are made
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return access;
}

void fail_to_read(const std::filesystem::path& path, const std::string& object, const std::string& why) {
  throw InputError(fmt::format("{}, {}: {}; the file is damaged or not of this kind", path.string(), object, why));
}

Handle make_space(const Shape& shape) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  if (sizes.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  return {H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose};
}

std::size_t elements(const Shape& shape) {
  std::size_t product = 1;
  for (const std::size_t size : shape) {
    if (__builtin_mul_overflow(product, size, &product)) return std::numeric_limits<std::size_t>::max();
  }
  return product;
}

namespace {

/// Refuses data that stand in other files (nothing has been opened yet) and filters other than those that h5py offers
/// everywhere, each at most once: two compressions, one upon the other, would make terabytes out of a small file.
void check_storage(const std::filesystem::path& path, const std::string& object, hid_t dataset) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(creation);
  const bool inside = layout == H5D_COMPACT || layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED;
  if (!inside || H5Pget_external_count(creation) != 0) fail_to_read(path, object, "its data are not in the file");
  std::vector<H5Z_filter_t> known{H5Z_FILTER_DEFLATE, H5Z_FILTER_SHUFFLE, H5Z_FILTER_FLETCHER32};
  const int filters = H5Pget_nfilters(creation);
  for (unsigned i = 0; static_cast<int>(i) < filters; ++i) {
    unsigned flags = 0;
    std::size_t values = 0;
    const H5Z_filter_t filter = H5Pget_filter2(creation, i, &flags, &values, nullptr, 0, nullptr, nullptr);
    if (std::erase(known, filter) == 0) fail_to_read(path, object, "its compression is not gzip");
  }
}

}  // namespace

Opened open_dataset(const std::filesystem::path& path, hid_t file, const std::string& object) {
  Handle dataset(H5Dopen2(file, object.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) fail_to_read(path, object, "there is no such dataset");
  check_storage(path, object, dataset);
  Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || H5Sget_simple_extent_type(space) == H5S_NULL) fail_to_read(path, object, "it has no shape");
  Opened opened{std::move(dataset), std::move(space), {}};
  std::array<hsize_t, H5S_MAX_RANK> sizes{};
  H5Sget_simple_extent_dims(opened.space, sizes.data(), nullptr);
  opened.shape.assign(sizes.begin(), sizes.begin() + rank);
  return opened;
}

void check_shape(const std::filesystem::path& path, const std::string& object, const Shape& found,
                 const Shape& expected) {
  if (found == expected) return;
  fail_to_read(path, object,
               fmt::format("its shape is [{}], not [{}]", fmt::join(found, ", "), fmt::join(expected, ", ")));
}

Handle select_row(const std::filesystem::path& path, const std::string& object, const Opened& opened, std::size_t row) {
  if (opened.shape.empty() || row >= opened.shape[0]) {
    fail_to_read(path, object, fmt::format("it has no row {}", row));
  }
  std::vector<hsize_t> start(opened.shape.size(), 0), count(opened.shape.begin(), opened.shape.end());
  start[0] = row;
  count[0] = 1;
  H5Sselect_hyperslab(opened.space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  return make_space(Shape(opened.shape.begin() + 1, opened.shape.end()));
}

}  // namespace hdf5

using namespace hdf5;

namespace {

/// Refuses a dataset whose elements are not numbers of the kind wanted, or that claims more data than the file can
/// hold: nothing is allocated on the word of a file.
template <class T>
void check_content(const std::filesystem::path& path, hid_t file, const std::string& object, const Opened& opened,
                   std::size_t wanted) {
  const Handle type(H5Dget_type(opened.dataset), H5Tclose);
  const H5T_class_t kind = std::is_same_v<T, double> ? H5T_FLOAT : H5T_INTEGER;
  if (H5Tget_class(type) != kind || H5Tget_size(type) > 8) {
    fail_to_read(path, object, kind == H5T_FLOAT ? "it does not hold real numbers" : "it does not hold integers");
  }
  if (!std::is_same_v<T, double> && H5Tget_size(type) > sizeof(T)) {
    fail_to_read(path, object, "its integers are too long");
  }
  hsize_t file_bytes = 0;
  H5Fget_filesize(file, &file_bytes);
  const Handle creation(H5Dget_create_plist(opened.dataset), H5Pclose);
  const bool chunked = H5Pget_layout(creation) == H5D_CHUNKED;
  const hsize_t compression = chunked && H5Pget_nfilters(creation) > 0 ? 1100 : 1;  // deflate: at most 1032 times
  const hsize_t stored = std::min(H5Dget_storage_size(opened.dataset), file_bytes);
  hsize_t least = wanted;
  if (chunked) {
    std::vector<hsize_t> sizes(opened.shape.size());
    H5Pget_chunk(creation, static_cast<int>(sizes.size()), sizes.data());
    least = std::max<hsize_t>(least, elements(Shape(sizes.begin(), sizes.end())));
  }
  if (least > compression * stored / H5Tget_size(type)) {
    fail_to_read(path, object, "it claims more data than the file holds");
  }
}

/// The transfer of numbers that must arrive as they are: the library would make the nearest possible one of a number
/// that does not fit the type wanted, such as 0 of a negative count.
Handle exact_transfer() {
  Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  const auto refuse = [](H5T_conv_except_t kind, hid_t, hid_t, void*, void*, void*) {
    const bool fits = kind != H5T_CONV_EXCEPT_RANGE_HI && kind != H5T_CONV_EXCEPT_RANGE_LOW;
    return fits ? H5T_CONV_UNHANDLED : H5T_CONV_ABORT;
  };
  H5Pset_type_conv_cb(transfer, refuse, nullptr);
  return transfer;
}

std::string without_padding(std::string text) {
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

}  // namespace

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  start_library();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(fmt::format("{} is not there or not a file: check the path", path.string()));
  }
  const Handle access = make_access();
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (id < 0)
    throw InputError(fmt::format("{} is not a readable HDF5 file: it is damaged or of another kind", path.string()));
  return {path, id, false};
}

bool Hdf5File::has(const std::string& object) const {
  // The library asks for every step of the way to exist.
  for (std::size_t slash = object.find('/', 1); slash != object.npos; slash = object.find('/', slash + 1)) {
    if (H5Lexists(id_, object.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return H5Lexists(id_, object.c_str(), H5P_DEFAULT) > 0;
}

Shape Hdf5File::shape(const std::string& object) const { return open_dataset(path_, id_, object).shape; }

template <class T>
std::vector<T> Hdf5File::read(const std::string& object, const Shape& expected) const {
  const Opened opened = open_dataset(path_, id_, object);
  check_shape(path_, object, opened.shape, expected);
  const std::size_t count = elements(expected);
  if (count == 0) return {};
  check_content<T>(path_, id_, object, opened, count);
  std::vector<T> values(count);
  if (H5Dread(opened.dataset, memory_type<T>(), H5S_ALL, H5S_ALL, exact_transfer(), values.data()) < 0) {
    fail_to_read(path_, object, "its data cannot be read");
  }
  return values;
}

template <class T>
std::vector<T> Hdf5File::read_row(const std::string& object, std::size_t row, const Shape& expected) const {
  const Opened opened = open_dataset(path_, id_, object);
  const Handle memory = select_row(path_, object, opened, row);
  check_shape(path_, object, Shape(opened.shape.begin() + 1, opened.shape.end()), expected);
  const std::size_t count = elements(expected);
  check_content<T>(path_, id_, object, opened, count);
  std::vector<T> values(count);
  if (H5Dread(opened.dataset, memory_type<T>(), memory, opened.space, exact_transfer(), values.data()) < 0) {
    fail_to_read(path_, object, "its data cannot be read");
  }
  return values;
}

std::string Hdf5File::read_text(const std::string& object, std::size_t limit) const {
  const Opened opened = open_dataset(path_, id_, object);
  check_shape(path_, object, opened.shape, {});
  const Handle type(H5Dget_type(opened.dataset), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0)
    fail_to_read(path_, object, "it is not a text");
  if (H5Tget_size(type) > limit) fail_to_read(path_, object, fmt::format("it is longer than {} bytes", limit));
  std::string text(H5Tget_size(type), '\0');
  if (H5Dread(opened.dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
    fail_to_read(path_, object, "its data cannot be read");
  }
  return without_padding(text);
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const {
  const std::string where = object + ", attribute " + name;
  const Handle attribute(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute < 0) fail_to_read(path_, where, "it is missing");
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  constexpr std::size_t longest = 1 << 12;
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Tget_size(type) > longest ||
      H5Sget_simple_extent_npoints(space) != 1) {
    fail_to_read(path_, where, "it is not a short text");
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) fail_to_read(path_, where, "it cannot be read");
  return without_padding(text);
}

#define SANDGLASS_HDF5_TYPE(T)                                                       \
  template std::vector<T> Hdf5File::read<T>(const std::string&, const Shape&) const; \
  template std::vector<T> Hdf5File::read_row<T>(const std::string&, std::size_t, const Shape&) const;
SANDGLASS_HDF5_TYPE(double)
SANDGLASS_HDF5_TYPE(std::uint64_t)
SANDGLASS_HDF5_TYPE(std::int64_t)
SANDGLASS_HDF5_TYPE(std::int32_t)
SANDGLASS_HDF5_TYPE(std::uint8_t)
#undef SANDGLASS_HDF5_TYPE

}  // namespace sandglass
