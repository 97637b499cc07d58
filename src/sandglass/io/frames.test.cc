#include "sandglass/io/frames.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <string>

#include "sandglass/core/errors.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/io/trajectory.h"

using namespace sandglass;

namespace {

const std::string xyz =
    "2\n"
    "Lattice=\"20.0 0.0 0.0 0.0 20.0 0.0 0.0 0.0 1.0\" Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1 Time=0.5\n"
    "Big 19.0 1.0 0.0 1.0 -2.0 0.0 2.0\n"
    "Small 5.0 6.0 0.0 0.5 0.25 0.0 1.0\n"
    "2\n"
    "Lattice=\"20.0 0.0 0.0 0.0 20.0 0.0 0.0 0.0 1.0\" Properties=species:S:1:pos:R:3:velo:R:3:radius:R:1 Time=1.0\n"
    "Big 0.5 19.5 0.0 1.0 -2.0 0.0 2.0\n"
    "Small 5.5 6.0 0.0 0.5 0.25 0.0 1.0\n";

const std::string dump =
    "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-10 10\n0 20\n-0.1 0.1\n"
    "ITEM: ATOMS id type x y ix iy\n7 2 9.0 1.0 3 0\n3 1 -5.0 6.0 0 -1\n";

std::vector<Frame> all_frames(FrameReader& reader) {
  std::vector<Frame> frames;
  Frame frame;
  while (reader.next(frame)) frames.push_back(frame);
  return frames;
}

}  // namespace

TEST_CASE("extended XYZ: times, species by radius, disks followed across the border") {
  const TemporaryFolder folder;
  spill(folder / "a.xyz", xyz);
  FrameReader reader(folder / "a.xyz", {});
  const auto frames = all_frames(reader);
  REQUIRE(frames.size() == 2);
  CHECK(reader.disks().box_length == 20);
  CHECK(reader.disks().mixture.radius[big] == 2);
  CHECK(reader.disks().mixture.mass[big] == 4);  // as the area
  CHECK(reader.disks().disks[0].species == big);
  CHECK(frames[0].time == 0.5);
  CHECK(frames[0].vy[0] == -2);
  CHECK(frames[1].x[0] == 20.5);
  CHECK(frames[1].y[0] == -0.5);
  CHECK(frames[1].x[1] == 5.5);
  CHECK(reader.largest_step() == doctest::Approx(1.5 / 20));
}

TEST_CASE("LAMMPS: order by id, images, lengths in small radii, time from steps") {
  const TemporaryFolder folder;
  spill(folder / "a.dump", dump);
  CHECK(message_of<InputError>([&] { FrameReader(folder / "a.dump", {}); }).find("--radii") != std::string::npos);
  FrameReader reader(folder / "a.dump", {.radii = {0.5, 0.75}, .timestep = 0.01});
  const auto frames = all_frames(reader);
  REQUIRE(frames.size() == 1);
  CHECK(reader.disks().box_length == 40);
  CHECK(reader.disks().mixture.radius[big] == 1.5);
  CHECK(reader.disks().disks[0].species == small);  // id 3
  CHECK(frames[0].time == 1);
  CHECK(frames[0].x[0] == 10);
  CHECK(frames[0].y[0] == 12 - 40);
  CHECK(frames[0].x[1] == 38 + 120);
  CHECK(!reader.has_velocities());
}

TEST_CASE("a trajectory of this program comes back, up to the last frame that was written") {
  const TemporaryFolder folder;
  State state = sample_state(6);
  create_trajectory(folder / "t.h5", state, 3);
  Frame frame;
  frame.resize(6);
  for (std::size_t id = 0; id < 6; ++id)
    frame.x[id] = 100.25 * static_cast<double>(id), frame.y[id] = -3, frame.vx[id] = 0.5;
  frame.time = 2;
  write_frame(folder / "t.h5", 0, 30, frame, state.box_length);
  frame.time = 3;
  write_frame(folder / "t.h5", 1, 60, frame, state.box_length);
  FrameReader reader(folder / "t.h5", {});
  const auto frames = all_frames(reader);
  REQUIRE(frames.size() == 2);
  CHECK(reader.counts_collisions());
  CHECK(frames[1].collisions_per_disk == 20);
  CHECK(frames[1].time == 3);
  for (std::size_t id = 0; id < 6; ++id) CHECK(frames[0].x[id] == doctest::Approx(frame.x[id]).epsilon(1e-14));
  CHECK(reader.largest_step() == 0);
}

TEST_CASE("velocities whose squares cannot be summed are refused, and the way out is named") {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& velocity) {
    spill(folder / "v.xyz", "2\nLattice=\"40 0 0 0 40 0 0 0 1\" Properties=pos:R:2:velo:R:2:radius:R:1\n1 1 " +
                                velocity + " 1\n9 9 0 0 1\n");
    read_all_frames(folder / "v.xyz", {});
  };
  const auto refused = [&](const std::string& velocity) { return message_of<InputError>([&] { read(velocity); }); };
  CHECK(refused("2e9 0").find("a shorter unit of time") != std::string::npos);
  CHECK(refused("1 -1e300").find("a shorter unit of time") != std::string::npos);
  CHECK(refused("9e-6 0").find("a longer unit of time") != std::string::npos);
  CHECK_NOTHROW(read("0 0"));
  CHECK_NOTHROW(read("-1e9 1e-5"));

  // A fluid that has cooled is read, and the frame counted.
  const std::string head = "2\nLattice=\"40 0 0 0 40 0 0 0 1\" Properties=pos:R:2:velo:R:2:radius:R:1\n";
  spill(folder / "cooled.xyz", head + "1 1 1 0 1\n9 9 0 0 1\n" + head + "1 1 1e-6 0 1\n9 9 0 0 1\n");
  FrameReader reader(folder / "cooled.xyz", {});
  CHECK(all_frames(reader).size() == 2);
  CHECK(reader.slow_frames() == 1);
}

TEST_CASE("whatever is done to a file, it is read or refused") {
  const TemporaryFolder folder;
  CHECK(rc::check("mutations", [&](bool from_xyz) {
    std::string text = from_xyz ? xyz : dump;
    const int changes = *rc::gen::inRange(1, 6);
    for (int i = 0; i < changes && !text.empty(); ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
      const auto kind = *rc::gen::inRange(0, 4);
      if (kind == 0) text[at] = *rc::gen::element('9', '-', ' ', '\n', 'e', '.', '\0', '"', ':', 'n');
      if (kind == 1) text.erase(at, *rc::gen::inRange<std::size_t>(1, 40));
      if (kind == 2) text.insert(at, *rc::gen::element<std::string>("99999999999", "1e308", "nan", "\n", "\"", " -1 "));
      if (kind == 3) text += text.substr(at);
    }
    spill(folder / "m", text);
    try {
      read_all_frames(folder / "m", {.radii = {1, 1.43}, .timestep = 1});
    } catch (const InputError&) {
    }
  }));
}
