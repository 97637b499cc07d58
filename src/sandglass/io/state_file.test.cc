#include "sandglass/io/state_file.h"

#include <doctest/doctest.h>
#include <hdf5.h>

#include <cmath>
#include <functional>

#include "sandglass/core/errors.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/seal.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

TEST_CASE("a state comes back with every bit") {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    CAPTURE(seed);
    const State state = sample_state(2 + 7 * seed, seed);
    write_state(folder / "state.h5", state);
    const State again = read_state(folder / "state.h5");
    CHECK(state_hash(again) == state_hash(state));
    // What the hash may not cover.
    CHECK(again.seed == state.seed);
    CHECK(again.epoch == state.epoch);
    CHECK(again.epoch_length == state.epoch_length);
    CHECK(again.mixture.radius == state.mixture.radius);
    CHECK(again.mixture.mass == state.mixture.mass);
    CHECK(again.collision.restitution == state.collision.restitution);
    CHECK(again.collision.collapse == state.collision.collapse);
    CHECK(again.collision.collapse_time == state.collision.collapse_time);
    CHECK(again.drive.kind == state.drive.kind);
    CHECK(again.drive.partner == state.drive.partner);
    CHECK(again.drive.reach == state.drive.reach);
    CHECK(again.drive.frequency == state.drive.frequency);
    CHECK(again.tally.contacts == state.tally.contacts);
    CHECK(again.tally.kicked == state.tally.kicked);
    CHECK(again.tally.virial == state.tally.virial);
    CHECK(again.tally.dissipated == state.tally.dissipated);
    CHECK(again.tally.injected == state.tally.injected);
    CHECK(again.tally.transits == state.tally.transits);
    CHECK(again.disks[0].last_contact == state.disks[0].last_contact);
    CHECK(again.disks[1].next_kick == state.disks[1].next_kick);
  }
}

TEST_CASE("states that cannot be are refused, each for its reason") {
  const TemporaryFolder folder;
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const std::vector<std::function<void(State&)>> spoil{
      [&](State& s) { s.box_length = nan; },
      [&](State& s) { s.box_length = -1; },
      [&](State& s) { s.mixture.radius[big] = 0; },
      [&](State& s) { s.mixture.mass[small] = infinity; },
      [&](State& s) { s.collision.restitution = 1.5; },
      [&](State& s) { s.collision.collapse = static_cast<CollapsePolicy>(7); },
      [&](State& s) { s.drive.kind = static_cast<DriveKind>(9); },
      [&](State& s) { s.drive.frequency = nan; },
      [&](State& s) { s.now = -1; },
      [&](State& s) { s.epoch = std::numeric_limits<std::uint64_t>::max(); },
      [&](State& s) { s.epoch_length = 1e308, s.epoch = 1000; },
      [&](State& s) { s.tally.elastic_contacts = 1000; },
      [&](State& s) { s.tally.contacts[1] = std::numeric_limits<std::uint64_t>::max(); },
      [&](State& s) { s.tally.kicks = std::numeric_limits<std::uint64_t>::max(); },
      [&](State& s) { s.disks[3].kick_count = std::numeric_limits<std::uint64_t>::max(); },
      [&](State& s) { s.disks[3].image_x = std::numeric_limits<std::int32_t>::min(); },
      [&](State& s) { s.disks[3].image_y = std::numeric_limits<std::int32_t>::max(); },
      [&](State& s) { s.disks.resize(1); },
      [&](State& s) { s.disks[3].species = static_cast<Species>(2); },
      [&](State& s) { s.disks[3].x = nan; },
      [&](State& s) { s.disks[3].y = 41; },
      [&](State& s) { s.disks[3].vx = infinity; },
      [&](State& s) { s.disks[3].time = 18; },
      [&](State& s) { s.disks[3].last_contact = 18; },
      [&](State& s) { s.disks[3].next_kick = 17; },
      [&](State& s) { s.disks[3].next_kick = nan; },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    State state = sample_state(5);
    spoil[i](state);
    write_state(folder / "bad.h5", state);
    CAPTURE(i);
    const std::string message = message_of<InputError>([&] { (void)read_state(folder / "bad.h5"); });
    CHECK(message.find("cannot be used") != std::string::npos);
  }
}

TEST_CASE("a sealed file that lies about its size is refused without being believed") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "state.h5";
  for (const hsize_t claimed : {hsize_t{1} << 30, hsize_t{1} << 50}) {
    write_state(path, sample_state(5));
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, "/state/disks/x", H5P_DEFAULT);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk = 1;
    H5Pset_chunk(creation, 1, &chunk);
    const hid_t space = H5Screate_simple(1, &claimed, nullptr);
    const hid_t dataset = H5Dcreate2(file, "/state/disks/x", H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    REQUIRE(dataset >= 0);
    H5Dclose(dataset), H5Sclose(space), H5Pclose(creation), H5Fclose(file);
    CHECK_THROWS_AS((void)read_state(path), InputError);  // the seal is broken
    seal_file(path);
    CHECK_THROWS_AS((void)read_state(path), InputError);
  }
}

TEST_CASE("files of another kind") {
  const TemporaryFolder folder;
  spill(folder / "text", "hello");
  spill(folder / "empty", "");
  Hdf5File::create(folder / "other.h5").close();
  for (const auto& path : {folder / "text", folder / "empty", folder / "other.h5", folder / "absent", folder.path()}) {
    CHECK_THROWS_AS((void)read_state(path), InputError);
    CHECK_THROWS_AS((void)read_start_file(path), InputError);
  }
}
