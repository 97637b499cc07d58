#include "sandglass/io/atomic_file.h"

#include <doctest/doctest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sandglass/core/errors.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/io/trajectory.h"

using namespace sandglass;

TEST_CASE("a file is replaced whole, and no temporary is left") {
  const TemporaryFolder folder;
  const auto path = folder / "a.txt";
  write_whole(path, "one");
  write_whole(path, std::string("two\0three", 9));
  CHECK(slurp(path) == std::string("two\0three", 9));
  CHECK(read_whole(path, 9) == slurp(path));
  CHECK_THROWS_AS(read_whole(path, 8), InputError);
  const auto fail = [](const std::filesystem::path& temporary) {
    spill(temporary, "half");
    throw RunError("killed");
  };
  CHECK_THROWS_AS(replace_file(path, fail), RunError);
  CHECK(slurp(path) == std::string("two\0three", 9));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("whatever stands in the place of the temporary is no obstacle, and a pipe there keeps nobody waiting") {
  const TemporaryFolder folder;
  const auto path = folder / "a.txt", temporary = folder / "a.txt.partial";
  REQUIRE(::mkfifo(temporary.c_str(), 0600) == 0);
  write_whole(path, "one");
  CHECK(slurp(path) == "one");
  spill(folder / "elsewhere", "mine");
  std::filesystem::create_symlink(folder / "elsewhere", temporary);
  write_whole(path, "two");
  CHECK(slurp(path) == "two");
  CHECK(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
  CHECK(slurp(folder / "elsewhere") == "mine");
  REQUIRE(::mkfifo(temporary.c_str(), 0600) == 0);
  write_state(path, sample_state(2));
  CHECK(read_state(path).size() == 2);
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK_NOTHROW(sync_file(folder / "pipe"));
}

TEST_CASE("folders that cannot be written are bad input") {
  const TemporaryFolder folder;
  spill(folder / "file", "x");
  CHECK_THROWS_AS(write_whole(folder / "absent/a.txt", "x"), InputError);
  CHECK_THROWS_AS(write_whole(folder / "file/a.txt", "x"), InputError);
  CHECK_THROWS_AS(write_state(folder / "absent/a.h5", sample_state(2)), InputError);
  std::filesystem::create_directories(folder / "taken/b");
  CHECK_THROWS_AS(write_whole(folder / "taken", "x"), InputError);
}

TEST_CASE("a full disk is a failure of the run and leaves what was there") {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  constexpr std::size_t disk_bytes = 1 << 20;
  if (geteuid() != 0 || mount("none", at.c_str(), "tmpfs", 0, "size=1m") != 0) {
    MESSAGE("skipped: a small file system cannot be mounted here");
    return;
  }
  const State little = sample_state(10), large = sample_state(disk_bytes / sizeof(Disk));
  std::vector<double> many(disk_bytes / sizeof(double));
  write_whole(folder / "a.txt", "old");
  write_checkpoint(folder / "checkpoint.h5", little, "", {});
  CHECK_THROWS_AS(write_whole(folder / "a.txt", std::string(disk_bytes, 'x')), RunError);
  for (int i = 0; i < 3; ++i) {
    CHECK_THROWS_AS(write_checkpoint(folder / "checkpoint.h5", large, "", {{"a", {{"many", &many}}}}), RunError);
    CHECK_THROWS_AS(write_observables(folder / "observables.h5", {{"/many", {many.size()}, many, ""}}), RunError);
    CHECK_THROWS_AS(create_trajectory(folder / "trajectory.h5", little, 10000), RunError);
  }
  CHECK(slurp(folder / "a.txt") == "old");
  CHECK(state_hash(read_checkpoint(folder / "checkpoint.h5", {}).state) == state_hash(little));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
  // With room again, writing goes on.
  write_checkpoint(folder / "checkpoint.h5", sample_state(11), "", {});
  CHECK(read_checkpoint(folder / "checkpoint.h5", {}).state.size() == 11);
  // Every size of file meets the end of the disk at another place.
  for (std::size_t used = 0; used < disk_bytes; used += 8192) {
    spill(folder / "filler", std::string(used, 'x'));
    try {
      write_checkpoint(folder / "checkpoint.h5", little, "", {});
    } catch (const RunError&) {
    }
    CHECK_NOTHROW(read_checkpoint(folder / "checkpoint.h5", {}));
  }
  CHECK(umount(at.c_str()) == 0);
}
