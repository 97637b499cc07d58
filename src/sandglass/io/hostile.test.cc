// Start files that no simulation wrote: each is refused for its reason, whatever it claims.
#include <doctest/doctest.h>
#include <hdf5.h>

#include <cmath>
#include <functional>

#include "sandglass/core/errors.h"
#include "sandglass/io/hdf5_library.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/io/trajectory.h"

using namespace sandglass;
using hdf5::Handle;

namespace {

constexpr std::size_t disks = 6;
const std::string all = "/particles/all/";

void edit(const std::filesystem::path& path, const std::function<void(hid_t)>& change) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, hdf5::make_access()), H5Fclose);
  REQUIRE(file >= 0);
  change(file);
}

/// As other programs write them: without checksums of the frames, so that what is wrong is found for what it is.
void write_good_trajectory(const std::filesystem::path& path) {
  const State state = sample_state(disks);
  Frame frame;
  make_frame(state, frame);
  create_trajectory(path, state, 2);
  write_frame(path, 0, 1, frame, state.box_length);
  edit(path, [](hid_t file) { REQUIRE(H5Ldelete(file, frame_checksums, H5P_DEFAULT) >= 0); });
}

/// Why a trajectory is refused after `change`; empty if it is not. (Read in this process, where a fault would be seen.)
std::string refusal(const std::function<void(hid_t)>& change) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "trajectory.h5";
  write_good_trajectory(path);
  edit(path, change);
  return message_of<InputError>([&] { (void)read_last_frame(path); });
}

/// Overwrites element `index` of a dataset.
template <class T>
std::function<void(hid_t)> put(const std::string& object, hsize_t index, T value) {
  return [=](hid_t file) {
    const Handle dataset(H5Dopen2(file, (all + object).c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(H5Dget_space(dataset), H5Sclose);
    std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(dataset, hdf5::memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    values.at(index) = value;
    REQUIRE(H5Dwrite(dataset, hdf5::memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
  };
}

/// Puts a new dataset in the place of an object; `prepare` may set how it is stored.
std::function<void(hid_t)> replace(
    const std::string& object, hid_t type, const Shape& shape,
    const std::function<void(hid_t creation, hid_t space)>& prepare = [](hid_t, hid_t) {}) {
  return [=](hid_t file) {
    H5Ldelete(file, (all + object).c_str(), H5P_DEFAULT);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), space = hdf5::make_space(shape);
    prepare(creation, space);
    const Handle dataset(H5Dcreate2(file, (all + object).c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                         H5Dclose);
    REQUIRE(dataset >= 0);
  };
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("the file that the others are spoilt from is a good one") {
  CHECK(refusal([](hid_t) {}).empty());
}

TEST_CASE("numbers that no disk can have") {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double value : {nan, infinity, -1.0, 41.0, 1e308}) {
    CAPTURE(value);
    CHECK(contains(refusal(put("position/value", 3, value)), "outside the box"));
  }
  CHECK(contains(refusal(put("velocity/value", 3, infinity)), "velocity"));
  for (const double value : {nan, infinity, -1.0, 0.0}) {
    CAPTURE(value);
    const auto both = [&](hid_t file) { put("box/edges", 0, value)(file), put("box/edges", 1, value)(file); };
    CHECK(!refusal(both).empty());
    const auto every = [&](hid_t file) {
      for (std::size_t id = 0; id < disks; ++id) put("radius", id, value)(file), put("mass", id, value)(file);
    };
    CHECK(!refusal(every).empty());
  }
  CHECK(contains(refusal(put("radius", 4, 1.1)), "neither of two species"));
  CHECK(contains(refusal(put<std::uint8_t>("species", 1, 2)), "neither of two species"));
  CHECK(contains(refusal(put<std::int32_t>("image/value", 1, std::numeric_limits<std::int32_t>::min())), "crossed"));
  CHECK(contains(refusal(put<std::int64_t>("position/step", 0, -1)), "no complete frame"));
  // The time of a frame is not used: a start begins at 0.
  CHECK(refusal(put("position/time", 0, nan)).empty());
}

TEST_CASE("a negative number is not taken for 0, nor a large one for the largest") {
  const auto with_species = [](std::int8_t value) {
    return refusal([=](hid_t file) {
      replace("species", H5T_STD_I8LE, {disks})(file);
      const std::vector<std::int8_t> values{0, 1, 0, 1, 0, value};
      const Handle dataset(H5Dopen2(file, (all + "species").c_str(), H5P_DEFAULT), H5Dclose);
      H5Dwrite(dataset, H5T_NATIVE_INT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    });
  };
  CHECK(with_species(1).empty());
  CHECK(contains(with_species(-1), "cannot be read"));
}

TEST_CASE("objects of a wrong kind, shape or type, or none") {
  for (const std::string object :
       {"species", "radius", "mass", "box/edges", "position/value", "velocity/value", "image/value", "position/step"}) {
    CAPTURE(object);
    CHECK(!refusal([&](hid_t file) { H5Ldelete(file, (all + object).c_str(), H5P_DEFAULT); }).empty());
    CHECK(!refusal(replace(object, H5T_C_S1, {disks})).empty());
    CHECK(!refusal(replace(object, H5T_IEEE_F64LE, {})).empty());
    CHECK(!refusal(replace(object, H5T_STD_I64LE, {1, 1, 1, 1})).empty());
    CHECK(!refusal(replace(object, H5T_STD_I64LE, {0})).empty());
    const auto links_to_itself = [&](hid_t file) {
      H5Ldelete(file, (all + object).c_str(), H5P_DEFAULT);
      H5Lcreate_soft((all + object).c_str(), file, (all + object).c_str(), H5P_DEFAULT, H5P_DEFAULT);
    };
    CHECK(!refusal(links_to_itself).empty());
    const auto is_a_group = [&](hid_t file) {
      H5Ldelete(file, (all + object).c_str(), H5P_DEFAULT);
      Handle(H5Gcreate2(file, (all + object).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    };
    CHECK(!refusal(is_a_group).empty());
  }
}

TEST_CASE("claims of more data than the file holds") {
  const auto in_chunks_of = [](hsize_t size) {
    return [=](hid_t creation, hid_t) { H5Pset_chunk(creation, 1, &size); };
  };
  for (const std::size_t claimed : {std::size_t{1} << 31, std::size_t{1} << 40, std::size_t{1} << 62}) {
    CAPTURE(claimed);
    CHECK(!refusal(replace("species", H5T_STD_U8LE, {claimed}, in_chunks_of(1))).empty());
    CHECK(contains(refusal(replace("position/step", H5T_STD_I64LE, {claimed}, in_chunks_of(1000))), "claims more"));
  }
  // One chunk as large as the library lets it be, for a dataset of a few disks.
  const auto huge_chunk = [](hid_t creation, hid_t) {
    const hsize_t size = 0xffffffff;
    H5Pset_chunk(creation, 1, &size);
    H5Pset_alloc_time(creation, H5D_ALLOC_TIME_INCR);
  };
  const auto growing = [&](hid_t file) {
    H5Ldelete(file, (all + "species").c_str(), H5P_DEFAULT);
    const hsize_t now = disks, limit = H5S_UNLIMITED;
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), space(H5Screate_simple(1, &now, &limit), H5Sclose);
    huge_chunk(creation, space);
    Handle(H5Dcreate2(file, (all + "species").c_str(), H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT),
           H5Dclose);
  };
  CHECK(contains(refusal(growing), "claims more"));
}

TEST_CASE("a compression upon a compression is refused, one is not") {
  const auto deflated = [](int times) {
    return [=](hid_t file) {
      constexpr hsize_t frames = 1 << 16;
      replace("position/step", H5T_STD_I64LE, {frames}, [=](hid_t creation, hid_t) {
        H5Pset_chunk(creation, 1, &frames);
        for (int i = 0; i < times; ++i) H5Pset_deflate(creation, 9);
      })(file);
      std::vector<std::int64_t> steps(frames, -1);
      steps[0] = 1;
      const Handle dataset(H5Dopen2(file, (all + "position/step").c_str(), H5P_DEFAULT), H5Dclose);
      REQUIRE(H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, steps.data()) >= 0);
    };
  };
  CHECK(refusal(deflated(1)).empty());
  CHECK(contains(refusal(deflated(2)), "compression"));
}

TEST_CASE("data that stand in another file are not fetched from there") {
  const auto elsewhere = [](hid_t creation, hid_t) { H5Pset_external(creation, "/etc/passwd", 0, disks); };
  CHECK(contains(refusal(replace("species", H5T_STD_U8LE, {disks}, elsewhere)), "not in the file"));
  const auto virtually = [](hid_t creation, hid_t space) {
    H5Pset_virtual(creation, space, "/etc/passwd", "/x", space);
  };
  CHECK(contains(refusal(replace("species", H5T_STD_U8LE, {disks}, virtually)), "not in the file"));
  // A dataset that is its own source would crash the library.
  const auto own_source = [](hid_t creation, hid_t space) {
    H5Pset_virtual(creation, space, ".", "/particles/all/species", space);
  };
  CHECK(contains(refusal(replace("species", H5T_STD_U8LE, {disks}, own_source)), "not in the file"));
}

TEST_CASE("damaged at any place, a trajectory is read, refused, or kills only the process that reads it") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "trajectory.h5";
  write_good_trajectory(path);
  const std::string whole = slurp(path);
  // The first kilobytes describe the file; most of the rest are numbers and room.
  for (std::size_t i = 0; i < 30; ++i) {
    const std::size_t at = i * i * (whole.size() - 1) / (29 * 29);
    CAPTURE(at);
    for (const char byte : {'\0', '\x01', '\xff'}) {
      std::string damaged = whole;
      damaged[at] = byte;
      spill(path, damaged);
      try {
        (void)read_start_file(path);
      } catch (const InputError&) {
      }
    }
    spill(path, whole.substr(0, at));
    CHECK_THROWS_AS((void)read_start_file(path), InputError);
  }
}

TEST_CASE("a text without an end is as long as its type says") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "state.h5";
  write_state(path, sample_state(disks));
  edit(path, [](hid_t file) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(type, 4000);
    H5Adelete_by_name(file, "/state", "format", H5P_DEFAULT);
    const Handle attribute(
        H5Acreate_by_name(file, "/state", "format", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(attribute, type, std::string(4000, 'x').data());
  });
  seal_file(path);
  CHECK(contains(message_of<InputError>([&] { (void)read_state(path); }), "another version"));
}
