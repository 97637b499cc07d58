#include "sandglass/io/hdf5.h"

#include <doctest/doctest.h>
#include <hdf5.h>

#include <bit>
#include <cmath>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

/// Makes a dataset that claims `sizes`, in chunks that were never written.
void claim(const std::filesystem::path& path, const char* object, hid_t type, std::vector<hsize_t> sizes) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const std::vector<hsize_t> chunk(sizes.size(), 1);
  H5Pset_chunk(creation, static_cast<int>(sizes.size()), chunk.data());
  const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
  const hid_t dataset = H5Dcreate2(file, object, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  REQUIRE(dataset >= 0);
  H5Dclose(dataset), H5Sclose(space), H5Pclose(creation), H5Fclose(file);
}

}  // namespace

TEST_CASE("every type comes back with the bits it had") {
  const TemporaryFolder folder;
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> reals{0.1, -0.0, infinity, -infinity, 5e-324, std::nan("")};
  const std::vector<std::uint64_t> counts{0, std::numeric_limits<std::uint64_t>::max()};
  const std::vector<std::int32_t> images{-1, std::numeric_limits<std::int32_t>::min()};
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write<double>("/x/y/reals", {2, 3}, reals);
    file.write<std::uint64_t>("/x/counts", {2}, counts);
    file.write<std::int32_t>("/x/images", {2}, images);
    file.write<std::uint64_t>("/x/none", {0}, {});
    file.write_text("/text", "a\nb é");
    file.write_text("/no_text", "");
    file.set_attribute("/x/counts", "unit", "R_s");
    file.close();
  }
  const Hdf5File file = Hdf5File::open(folder / "a.h5");
  const auto found = file.read<double>("/x/y/reals", {2, 3});
  for (std::size_t i = 0; i < reals.size(); ++i) {
    CHECK(std::bit_cast<std::uint64_t>(found[i]) == std::bit_cast<std::uint64_t>(reals[i]));
  }
  CHECK(file.read_row<double>("/x/y/reals", 1, {3})[0] == -infinity);
  CHECK(file.read<std::uint64_t>("/x/counts", {2}) == counts);
  CHECK(file.read<std::int32_t>("/x/images", {2}) == images);
  CHECK(file.read<std::uint64_t>("/x/none", {0}).empty());
  CHECK(file.read_text("/text", 100) == "a\nb é");
  CHECK(file.read_text("/no_text", 100).empty());
  CHECK(file.text_attribute("/x/counts", "unit") == "R_s");
  CHECK(file.has("/x/y"));
  CHECK(!file.has("/x/z/w"));
}

TEST_CASE("wrong types, shapes and names are refused before anything is allocated") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "a.h5";
  {
    Hdf5File file = Hdf5File::create(path);
    file.write<double>("/reals", {3}, std::vector<double>(3));
    file.write<std::uint64_t>("/counts", {3}, std::vector<std::uint64_t>(3));
    file.write_text("/text", "text");
    file.close();
  }
  claim(path, "/huge", H5T_IEEE_F64LE, {hsize_t{1} << 40});
  claim(path, "/wraps", H5T_IEEE_F64LE, {hsize_t{1} << 32, hsize_t{1} << 30, hsize_t{1} << 30});
  const Hdf5File file = Hdf5File::open(path);
  CHECK_THROWS_AS((void)file.read<double>("/counts", {3}), InputError);
  CHECK_THROWS_AS((void)file.read<std::uint64_t>("/reals", {3}), InputError);
  CHECK_THROWS_AS((void)file.read<std::uint8_t>("/counts", {3}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/text", {}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/reals", {4}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/reals", {3, 1}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/reals", {}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/absent", {3}), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/", {3}), InputError);
  CHECK_THROWS_AS((void)file.read_row<double>("/reals", 3, {}), InputError);
  CHECK_THROWS_AS((void)file.read_text("/text", 3), InputError);
  CHECK_THROWS_AS((void)file.read_text("/reals", 100), InputError);
  CHECK_THROWS_AS((void)file.text_attribute("/reals", "unit"), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/huge", file.shape("/huge")), InputError);
  CHECK_THROWS_AS((void)file.read<double>("/wraps", file.shape("/wraps")), InputError);
}

TEST_CASE("what is no HDF5 file is bad input") {
  const TemporaryFolder folder;
  spill(folder / "text", "hello");
  spill(folder / "empty", "");
  for (const auto& path : {folder / "text", folder / "empty", folder / "absent", folder.path()}) {
    CHECK_THROWS_AS(Hdf5File::open(path), InputError);
  }
  CHECK_THROWS_AS(Hdf5File::create(folder / "no/such/folder.h5"), InputError);
  for (const auto& path : {folder / "text", folder / "absent", folder.path()}) {
    CHECK_THROWS_AS(Hdf5File::open_to_write(path), RunError);
  }
}

TEST_CASE("observables: groups from paths, units, whole or not at all") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "observables.h5";
  write_observables(path, {{"/dynamics/all/msd/value", {2}, std::vector<double>{1.5, 2.5}, "R_s^2"},
                           {"/dynamics/all/msd/count", {2}, std::vector<std::uint64_t>{7, 8}, ""}});
  {
    const Hdf5File file = Hdf5File::open(path);
    CHECK(file.read<double>("/dynamics/all/msd/value", {2}) == std::vector<double>{1.5, 2.5});
    CHECK(file.text_attribute("/dynamics/all/msd/value", "unit") == "R_s^2");
    CHECK(file.read<std::uint64_t>("/dynamics/all/msd/count", {2})[1] == 8);
    CHECK(file.text_attribute("/dynamics/all/msd/count", "unit").empty());
  }
  const std::string before = slurp(path);
  CHECK_THROWS_AS(write_observables(path, {{"/a", {3}, std::vector<double>(2), ""}}), std::logic_error);
  CHECK(slurp(path) == before);
  CHECK(!std::filesystem::exists(path.string() + ".partial"));
  write_observables(folder / "again.h5", {{"/dynamics/all/msd/value", {2}, std::vector<double>{1.5, 2.5}, "R_s^2"},
                                          {"/dynamics/all/msd/count", {2}, std::vector<std::uint64_t>{7, 8}, ""}});
  CHECK(slurp(folder / "again.h5") == before);  // equal data make equal files
}
