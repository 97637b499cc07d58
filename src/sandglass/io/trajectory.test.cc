#include "sandglass/io/trajectory.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <rapidcheck.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <optional>

#include "sandglass/core/errors.h"
#include "sandglass/io/frames.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

constexpr std::size_t disks = 6;

Frame sample_frame(double time) {
  Frame frame;
  frame.resize(disks);
  frame.time = time;
  for (std::size_t id = 0; id < disks; ++id) {
    const auto i = static_cast<double>(id);
    frame.x[id] = 30 * time + i, frame.y[id] = -50 * time - i;
    frame.vx[id] = 0.1 * i, frame.vy[id] = time;
  }
  return frame;
}

}  // namespace

TEST_CASE("a wrapped coordinate is in [0, L) and means the same place") {
  CHECK(wrap(-1e-30, 10).position == 0);  // -1e-30 + 10 rounds to 10
  CHECK(wrap(10, 10).position == 0);
  CHECK(wrap(10, 10).image == 1);
  CHECK(wrap(-0.0, 10).image == 0);
  CHECK(wrap(-1, 10).image == -1);
  CHECK_THROWS_AS(wrap(1e300, 10), RunError);
  CHECK_THROWS_AS(wrap(std::nan(""), 10), RunError);
  CHECK(rc::check("wrap", [] {
    const double box = 1 + static_cast<double>(*rc::gen::inRange(0, 1000000)) / 977;
    const double turns = static_cast<double>(*rc::gen::inRange(-1000000, 1000000));
    const double offset = *rc::gen::element(0.0, 1e-18, -1e-18, 0.25, std::nextafter(1.0, 0.0));
    const double x = (turns + offset) * box;
    const Wrapped w = wrap(x, box);
    RC_ASSERT(w.position >= 0 && w.position < box);
    // Quotient, product and difference are each rounded once: within 4 units of rounding of |x|.
    RC_ASSERT(std::fabs(w.position + w.image * box - x) <= 4 * 0x1p-53 * (std::fabs(x) + box));
  }));
}

TEST_CASE("a bit that has flipped in a frame is found by whoever reads it") {
  const TemporaryFolder folder;
  const auto path = folder / "trajectory.h5";
  const State state = sample_state(disks);
  create_trajectory(path, state, 3);
  for (std::uint64_t i = 0; i < 2; ++i)
    write_frame(path, i, static_cast<std::int64_t>(7 * i), sample_frame(0.01 * static_cast<double>(i)),
                state.box_length);
  CHECK(message_of<InputError>([&] { read_all_frames(path, {}); }).empty());
  for (const char* name : {"position/value", "velocity/value", "image/value", "position/time", "position/step"}) {
    CAPTURE(name);
    const auto spoilt = folder / "spoilt.h5";
    std::filesystem::copy_file(path, spoilt, std::filesystem::copy_options::overwrite_existing);
    const auto object = std::string("/particles/all/") + name;
    const auto flip_last_bit = [&]<class T>(T) {
      Hdf5File file = Hdf5File::open_to_write(spoilt);
      Shape row = file.shape(object);
      row.erase(row.begin());
      std::vector<T> values = file.read_row<T>(object, 1, row);
      if constexpr (std::is_same_v<T, double>)
        values[0] = std::nextafter(values[0], 1e9);
      else
        values[0] ^= 1;
      file.write_row<T>(object, 1, values);
      file.close();
    };
    if (object.ends_with("image/value"))
      flip_last_bit(std::int32_t{});
    else if (object.ends_with("step"))
      flip_last_bit(std::int64_t{});
    else
      flip_last_bit(double{});
    CHECK(message_of<InputError>([&] { read_all_frames(spoilt, {}); }).find("frame 1 is damaged") != std::string::npos);
    CHECK(message_of<InputError>([&] { (void)read_start_file(spoilt); }).find("frame 1 is damaged") !=
          std::string::npos);
  }
}

TEST_CASE("frames are not written into a file that is not the trajectory of this run") {
  const TemporaryFolder folder;
  const auto path = folder / "trajectory.h5";
  create_trajectory(path, sample_state(disks), 3);
  CHECK(message_of<InputError>([&] { check_trajectory(path, disks, 3); }).empty());
  CHECK_THROWS_AS(check_trajectory(path, disks, 4), InputError);
  CHECK_THROWS_AS(check_trajectory(path, disks + 1, 3), InputError);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  CHECK_THROWS_AS(check_trajectory(path, disks, 3), InputError);
  spill(path, "no HDF5");
  CHECK_THROWS_AS(check_trajectory(path, disks, 3), InputError);
  std::filesystem::remove(path);
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  CHECK_THROWS_AS(check_trajectory(path, disks, 3), InputError);
}

TEST_CASE("a trajectory with some of its frames is complete and says which") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "trajectory.h5";
  const State state = sample_state(disks);
  create_trajectory(path, state, 5);
  CHECK(message_of<InputError>([&] { (void)read_start_file(path); }).find("no complete frame") != std::string::npos);
  write_frame(path, 0, 0, sample_frame(0), state.box_length);
  write_frame(path, 1, 42, sample_frame(1.5), state.box_length);

  std::optional<Hdf5File> opened = Hdf5File::open(path);
  const Hdf5File& file = *opened;
  CHECK(file.read<std::int64_t>("/particles/all/velocity/step", {5}) == std::vector<std::int64_t>{0, 42, -1, -1, -1});
  const auto time = file.read<double>("/particles/all/image/time", {5});
  CHECK(time[1] == 1.5);
  CHECK(std::isnan(time[2]));
  const auto position = file.read_row<double>("/particles/all/position/value", 1, {disks, 2});
  const auto image = file.read_row<std::int32_t>("/particles/all/image/value", 1, {disks, 2});
  const Frame frame = sample_frame(1.5);
  for (std::size_t id = 0; id < disks; ++id) {
    // One subtraction of at most 2 L, rounded.
    CHECK(position[2 * id] + image[2 * id] * state.box_length == doctest::Approx(frame.x[id]).epsilon(1e-15));
    CHECK(position[2 * id + 1] + image[2 * id + 1] * state.box_length == doctest::Approx(frame.y[id]).epsilon(1e-15));
  }
  CHECK(file.text_attribute("/particles/all/position/value", "unit") == "R_s");
  CHECK(file.read<double>("/particles/all/radius", {disks})[1] == state.mixture.radius[big]);

  const State last = read_start_file(path);
  CHECK(last.box_length == state.box_length);
  CHECK(last.mixture.radius == state.mixture.radius);
  CHECK(last.disks[3].x == position[6]);
  CHECK(last.disks[3].image_y == image[7]);
  CHECK(last.disks[3].vy == 1.5);
  CHECK(last.disks[3].species == big);

  opened.reset();
  CHECK_THROWS_AS(write_frame(path, 5, 1, sample_frame(1), 40.1), InputError);
  Frame other = sample_frame(1);
  other.resize(disks + 1);
  CHECK_THROWS_AS(write_frame(path, 2, 1, other, 40.1), InputError);
}

TEST_CASE("killed while it writes frames, the file stays readable with all frames that were said to be complete") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "trajectory.h5";
  const State state = sample_state(disks);
  constexpr std::size_t frames = 10000;
  for (const useconds_t delay : {500, 5000, 20000}) {
    create_trajectory(path, state, frames);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      for (std::size_t i = 0; i < frames; ++i) {
        write_frame(path, i, static_cast<std::int64_t>(i), sample_frame(static_cast<double>(i)), state.box_length);
      }
      _exit(0);
    }
    usleep(delay);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const Hdf5File file = Hdf5File::open(path);
    const auto step = file.read<std::int64_t>("/particles/all/position/step", {frames});
    const auto time = file.read<double>("/particles/all/position/time", {frames});
    bool ended = false;
    for (std::size_t i = 0; i < frames; ++i) {
      ended = ended || step[i] == -1;
      CHECK(step[i] == (ended ? -1 : static_cast<std::int64_t>(i)));
      if (!ended) CHECK(time[i] == static_cast<double>(i));
    }
  }
}

TEST_CASE("other programs read it") {
  if (std::system("/usr/bin/python3 -c 'import h5py' > /dev/null 2>&1") != 0) {
    MESSAGE("skipped: no h5py");
    return;
  }
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "trajectory.h5", sealed = folder / "state.h5";
  create_trajectory(path, sample_state(disks), 5);
  write_frame(path, 0, 0, sample_frame(0), 40.1);
  write_frame(path, 1, 9, sample_frame(2), 40.1);
  write_state(sealed, sample_state(disks));
  const char* script = R"(
import h5py, sys
f = h5py.File(sys.argv[1], 'r')
assert list(f['h5md'].attrs['version']) == [1, 1]
assert f['h5md/creator'].attrs['name'] == b'sandglass' and 'name' in f['h5md/author'].attrs
p = f['particles/all']
assert p['box'].attrs['dimension'] == 2 and list(p['box'].attrs['boundary']) == [b'periodic'] * 2
assert p['box/edges'].shape == (2,)
for name in ['position', 'image', 'velocity']:
    assert p[name]['value'].shape == (5, 6, 2)
    assert list(p[name]['step']) == [0, 9, -1, -1, -1] and p[name]['time'][1] == 2
x = p['position/value'][:2]
assert (x >= 0).all() and (x < 40.1).all()
assert abs(p['position/value'][1, 0, 0] + 40.1 * p['image/value'][1, 0, 0] - 60) < 1e-13
assert h5py.File(sys.argv[2], 'r')['state/disks/x'].shape == (6,)
)";
  spill(folder / "look.py", script);
  const auto command = fmt::format("HDF5_USE_FILE_LOCKING=FALSE /usr/bin/python3 {} {} {}",
                                   (folder / "look.py").string(), path.string(), sealed.string());
  CHECK(std::system(command.c_str()) == 0);
}
