#include "hdf5_mutator.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "fuzz.h"
#include "sandglass/io/hdf5_library.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace sandglass {

using hdf5::Handle;

namespace {

constexpr std::size_t most_bytes = 4096;  // of a dataset that is written out

class Mutator {
 public:
  Mutator(hid_t file, unsigned seed) : file_(file), random_(seed) {}

  void mutate() {
    datasets_.clear();
    H5Ovisit2(file_, H5_INDEX_NAME, H5_ITER_INC, note_dataset, this, H5O_INFO_BASIC);
    if (datasets_.empty()) return;
    const std::string name = any(datasets_);
    switch (below(9)) {
      case 0:
        return replace(name, type_of(name), other_shape(name), H5D_CONTIGUOUS);
      case 1:
        return replace(name, other_type(), shape_of(name), H5D_CONTIGUOUS);
      case 2:
        return replace(name, type_of(name), shape_of(name), any(layouts));
      case 3:
        return replace_link(name);
      case 4:
        return change_attribute(name);
      default:
        return change_values(name);
    }
  }

 private:
  static constexpr std::array layouts{H5D_COMPACT, H5D_CHUNKED, H5D_VIRTUAL, H5D_NLAYOUTS};  // the last: another file

  static herr_t note_dataset(hid_t, const char* name, const H5O_info_t* info, void* self) {
    if (info->type == H5O_TYPE_DATASET) static_cast<Mutator*>(self)->datasets_.emplace_back(name);
    return 0;
  }

  std::size_t below(std::size_t end) { return random_() % end; }
  template <class List>
  typename List::value_type any(const List& list) {
    return list[below(list.size())];
  }

  Handle open(const std::string& name) { return {H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose}; }
  Handle type_of(const std::string& name) { return {H5Dget_type(open(name)), H5Tclose}; }
  std::vector<hsize_t> shape_of(const std::string& name) {
    const Handle space(H5Dget_space(open(name)), H5Sclose);
    std::vector<hsize_t> shape(H5S_MAX_RANK);
    const int rank = H5Sget_simple_extent_dims(space, shape.data(), nullptr);
    shape.resize(rank < 0 ? 0 : static_cast<std::size_t>(rank));
    return shape;
  }

  std::vector<hsize_t> other_shape(const std::string& name) {
    std::vector<hsize_t> shape = shape_of(name);
    const std::size_t change = below(4);
    if (change == 0) shape.push_back(1 + below(3));
    if (change == 1 && !shape.empty()) shape.pop_back();
    if (change > 1 && !shape.empty()) {
      hsize_t& size = shape[below(shape.size())];
      size = any(std::array<hsize_t, 7>{0, 1, size + 1, size - 1, 1u << 31, hsize_t{1} << 40, hsize_t{1} << 62});
    }
    return shape;
  }

  Handle other_type() {
    const std::array numbers{H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_IEEE_F32LE, H5T_STD_I64LE,  H5T_STD_U64BE,
                             H5T_STD_I8LE,   H5T_STD_U16LE,  H5T_C_S1,       H5T_STD_REF_OBJ};
    const hid_t base = any(numbers);
    switch (below(4)) {
      case 0: {
        Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
        H5Tset_size(text, below(2) == 0 ? H5T_VARIABLE : 1 + below(100));
        return text;
      }
      case 1: {
        Handle record(H5Tcreate(H5T_COMPOUND, 16), H5Tclose);
        H5Tinsert(record, "a", 0, H5T_IEEE_F64LE);
        H5Tinsert(record, "b", 8, H5T_STD_U64LE);
        return record;
      }
      default:
        return {H5Tcopy(base), H5Tclose};
    }
  }

  /// Puts another dataset in the place of `name`; what is too large to be written is claimed in chunks without data.
  void replace(const std::string& name, const Handle& type, std::vector<hsize_t> shape, H5D_layout_t layout) {
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const int rank = static_cast<int>(shape.size());
    const Handle space(rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, shape.data(), nullptr), H5Sclose);
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    const bool large = points < 0 || static_cast<hsize_t>(points) > most_bytes / 16;
    if (large || layout == H5D_CHUNKED) {
      for (hsize_t& size : shape) size = large ? any(std::array<hsize_t, 3>{1, 1000, 1u << 20}) : 1 + below(size + 1);
      H5Pset_chunk(creation, rank, shape.data());
      for (std::size_t filters = below(4); filters-- > 0;) add_filter(creation);
    } else if (layout == H5D_COMPACT) {
      H5Pset_layout(creation, layout);
    } else if (layout == H5D_VIRTUAL) {
      H5Pset_virtual(creation, space, ".", any(datasets_).c_str(), space);
    } else if (layout == H5D_NLAYOUTS) {
      H5Pset_external(creation, "/etc/passwd", 0, H5F_UNLIMITED);
    }
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    const Handle dataset(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
    if (!large && dataset >= 0) write_any(dataset);
  }

  /// (Not n-bit, which crashes when it writes some types.)
  void add_filter(hid_t creation) {
    switch (below(4)) {
      case 0:
        H5Pset_shuffle(creation);
        return;
      case 1:
        H5Pset_fletcher32(creation);
        return;
      default:
        H5Pset_deflate(creation, 9);
    }
  }

  void write_any(hid_t dataset) {
    std::vector<std::uint8_t> bytes(most_bytes);
    for (std::uint8_t& byte : bytes) byte = below(3) == 0 ? static_cast<std::uint8_t>(below(256)) : 0;
    write_raw(dataset, bytes);
  }

  /// Nothing is written where the bytes would be addresses.
  static void write_raw(hid_t dataset, const std::vector<std::uint8_t>& bytes) {
    const Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
    if (H5Tis_variable_str(type) > 0 || H5Tget_class(type) == H5T_REFERENCE) return;
    const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    if (H5Pget_external_count(creation) > 0 || H5Pget_layout(creation) == H5D_VIRTUAL) return;
    if (static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) > bytes.size() / H5Tget_size(type)) return;
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  }

  /// Bytes mutated by libFuzzer, or one number replaced by one from the end of its range.
  void change_values(const std::string& name) {
    const Handle dataset = open(name), type = type_of(name), space(H5Dget_space(dataset), H5Sclose);
    const std::size_t size = H5Tget_size(type);
    const auto points = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
    if (size == 0 || points == 0 || points > most_bytes / size) return;
    const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
    if (H5Pget_external_count(creation) > 0 || H5Pget_layout(creation) == H5D_VIRTUAL || H5Tis_variable_str(type) > 0)
      return;  // (a virtual dataset that is its own source crashes the library)
    std::vector<std::uint8_t> bytes(points * size);
    if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) return;
    std::uint8_t* element = bytes.data() + below(points) * size;
    const bool real = H5Tget_class(type) == H5T_FLOAT && size == sizeof(double);
    switch (below(3)) {
      case 0:
        LLVMFuzzerMutate(bytes.data(), bytes.size(), bytes.size());
        break;
      case 1:
        LLVMFuzzerMutate(element, size, size);
        break;
      default:
        if (real) {
          const double value = any(end_values);
          std::memcpy(element, &value, sizeof value);
        } else {
          std::memset(element, any(std::array{0, 1, 0x7f, 0xff}), size);
          if (below(2) == 0) element[size - 1] = any(std::array<std::uint8_t, 3>{0x7f, 0x80, 0});
        }
    }
    write_raw(dataset, bytes);
  }

  /// No object, another object, a group, or a soft link (perhaps to itself) where `name` was.
  void replace_link(const std::string& name) {
    const std::string other = any(datasets_);
    const std::size_t kind = below(5);
    if (kind == 0) {
      if (other == name) return;
      H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
      H5Lcreate_hard(file_, other.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      return;
    }
    H5Ldelete(file_, name.c_str(), H5P_DEFAULT);
    if (kind == 1) H5Lcreate_soft(("/" + other).c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (kind == 2) Handle(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  }

  /// Another text, or none, for the first attribute of a group on the way to `name`.
  void change_attribute(const std::string& name) {
    const std::string group = name.substr(0, name.find('/', below(name.size())));
    char attribute[100] = "unit";
    H5Aget_name_by_idx(file_, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, below(2), attribute, sizeof attribute,
                       H5P_DEFAULT);
    H5Adelete_by_name(file_, group.c_str(), attribute, H5P_DEFAULT);
    if (below(3) == 0) return;
    const Handle type = other_type();
    const hsize_t one = 1;
    const Handle space(below(2) == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &one, nullptr), H5Sclose);
    const Handle made(
        H5Acreate_by_name(file_, group.c_str(), attribute, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Aclose);
    if (made < 0 || H5Tis_variable_str(type) > 0 || H5Tget_class(type) == H5T_REFERENCE) return;
    std::vector<std::uint8_t> bytes(most_bytes, static_cast<std::uint8_t>('0' + below(3)));
    H5Awrite(made, type, bytes.data());
  }

  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr std::array end_values{std::numeric_limits<double>::quiet_NaN(),
                                         infinity,
                                         -infinity,
                                         0.0,
                                         -0.0,
                                         -1.0,
                                         1.0,
                                         1e308,
                                         -1e308,
                                         5e-324,
                                         0x1p53,
                                         40.1};

  hid_t file_;
  std::minstd_rand random_;
  std::vector<std::string> datasets_;
};

}  // namespace
}  // namespace sandglass

using namespace sandglass;

/// What cannot be opened (the empty first input) becomes the seed.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  hdf5::start_library();
  static MemoryFile memory;
  memory.fill(data, size);
  {
    const Handle access = hdf5::make_access();
    hid_t id = H5Fopen(memory.path().c_str(), H5F_ACC_RDWR, access);
    if (id < 0) {
      write_seed(memory.path());
      id = H5Fopen(memory.path().c_str(), H5F_ACC_RDWR, access);
    }
    const Handle file(id, H5Fclose);
    Mutator mutator(file, seed);
    for (unsigned turn = 0; turn <= seed % 3; ++turn) mutator.mutate();
  }
  const std::string mutated = memory.contents();
  if (mutated.size() > max_size) return size;
  std::memcpy(data, mutated.data(), mutated.size());
  return mutated.size();
}

/// SANDGLASS_SEED=FILE writes the seed and ends, to renew the corpus when a format has changed.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (const char* path = std::getenv("SANDGLASS_SEED")) {
    write_seed(path);
    std::exit(0);
  }
  return 0;
}
