#include "sandglass/study/campaign_status.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sandglass/io/run_folder.h"
#include "sandglass/io/summary.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/study/run_progress.h"

using namespace sandglass;

namespace {

/// As another host would have left it.
void progress_of_another_host(const std::filesystem::path& folder) {
  spill(progress_file(folder),
        R"({"stage": "measuring", "remark": "", "fraction": 0.5, "seconds_left": 10, "host": "elsewhere"})");
}

}  // namespace

TEST_CASE("a point is not started, then running while its lock is held, then stopped, then done") {
  const TemporaryFolder scratch;
  const auto folder = scratch / "run";
  std::filesystem::create_directory(folder);
  spill(folder / "config.toml", "");
  CHECK(status_of(folder).state == PointState::not_started);
  {
    RunFolder held = RunFolder::open(folder, FolderMode::resume);
    CHECK(status_of(folder).state == PointState::running);
    ProgressFile file(folder, Config{}, 0);
    file.show("measuring (2.00 million collisions/s)", 0.5);
    const PointStatus status = status_of(folder);
    // Of 1000 collisions per disk of equilibration and 10000 of measurement 6000 are done.
    CHECK(status.fraction == doctest::Approx(6000.0 / 11000));
    CHECK(status.stage == "measuring");
    CHECK(status.remark == "2.00 million collisions/s");
  }
  CHECK(status_of(folder).state == PointState::stopped);
  CHECK(status_of(folder).fraction == doctest::Approx(6000.0 / 11000));

  ProgressFile file(folder, Config{}, 0);
  file.failed("no room");
  CHECK(status_of(folder).state == PointState::failed);
  CHECK(status_of(folder).remark == "no room");

  Summary summary;
  summary.wall_seconds = 7;
  write_summary(folder / "summary.json", summary);
  file.finished();
  CHECK(status_of(folder).state == PointState::done);
  CHECK(*status_of(folder).wall_seconds == 7);
  CHECK(status_of(folder).fraction == 1);
}

TEST_CASE("a lock file alone is left over, not a run; looking at it changes nothing") {
  const TemporaryFolder scratch;
  spill(scratch / ".lock", "");
  spill(scratch / "checkpoint.h5", "");
  const auto before = std::filesystem::last_write_time(scratch / ".lock");
  CHECK(status_of(scratch.path()).state == PointState::stopped);
  CHECK(std::filesystem::last_write_time(scratch / ".lock") == before);
  CHECK(RunFolder::open(scratch.path(), FolderMode::resume).path() == scratch.path());
}

TEST_CASE("a lock seen only as a record lock, as of another client of a network file system") {
  const TemporaryFolder scratch;
  spill(scratch / ".lock", "");
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    const int descriptor = ::open((scratch / ".lock").c_str(), O_RDWR);
    const bool held = ::fcntl(descriptor, F_SETLK, &lock) == 0;
    (void)!::write(ready[1], held ? "y" : "n", 1);
    ::pause();
    ::_exit(0);
  }
  char answer = 0;
  REQUIRE(::read(ready[0], &answer, 1) == 1);
  CHECK(answer == 'y');
  CHECK(is_running(scratch.path()));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(!is_running(scratch.path()));
}

TEST_CASE("a lock that cannot be seen counts while its host tells of progress") {
  const TemporaryFolder scratch;
  progress_of_another_host(scratch.path());
  CHECK(!is_running(scratch.path()));  // no lock file: it has ended
  spill(scratch / ".lock", "");
  CHECK(is_running(scratch.path()));
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::minutes(3);
  std::filesystem::last_write_time(progress_file(scratch.path()), long_ago);
  CHECK(!is_running(scratch.path()));
}

TEST_CASE("a progress file that makes no sense is as none") {
  const TemporaryFolder scratch;
  for (const char* text :
       {"", "{", "[]", "{\"stage\": 3}", "{\"stage\": \"a\", \"remark\": \"\", \"fraction\": \"x\"}"}) {
    spill(progress_file(scratch.path()), text);
    CHECK(!read_progress(scratch.path()));
  }
  CHECK(status_of(scratch.path()).state == PointState::not_started);
}
