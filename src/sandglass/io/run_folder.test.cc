#include "sandglass/io/run_folder.h"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

std::string refusal(const std::filesystem::path& path, FolderMode mode) {
  return message_of<InputError>([&] { RunFolder::open(path, mode); });
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a new folder is made, and removed again if the run does not begin") {
  const TemporaryFolder folder;
  const auto path = folder / "a/b/c/";
  {
    RunFolder run = RunFolder::open(path, FolderMode::fresh);
    CHECK(std::filesystem::is_directory(path));
    CHECK(!run.holds_run());
  }
  CHECK(!std::filesystem::exists(folder / "a"));
  {
    RunFolder run = RunFolder::open(path, FolderMode::fresh);
    run.begin();
  }
  CHECK(std::filesystem::is_directory(path));
  CHECK(std::filesystem::is_empty(path));
}

TEST_CASE("a folder in use is refused, in this process and from another") {
  const TemporaryFolder folder;
  std::optional<RunFolder> first = RunFolder::open(folder / "run", FolderMode::fresh);
  for (const FolderMode mode : {FolderMode::fresh, FolderMode::force, FolderMode::resume}) {
    CHECK(contains(refusal(folder / "run", mode), "in use"));
    const pid_t child = fork();
    if (child == 0) _exit(contains(refusal(folder / "run", mode), "in use") ? 7 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    CHECK(WEXITSTATUS(status) == 7);
  }
  first.reset();
  CHECK(refusal(folder / "run", FolderMode::fresh).empty());
}

TEST_CASE("another run is not overwritten without force, and then only its own files go") {
  const TemporaryFolder folder;
  const auto path = folder / "run";
  std::filesystem::create_directory(path);
  for (const char* name : {"config.toml", "summary.json", "checkpoint.h5", "checkpoint.previous.h5", "trajectory.h5",
                           "observables.h5", "report.html", "run.log", "output.log", "progress.json",
                           "progress.json.partial", "trajectory.h5.partial", "notes.txt"}) {
    spill(path / name, name);
  }
  CHECK(contains(refusal(path, FolderMode::fresh), "--force"));
  CHECK(std::distance(std::filesystem::directory_iterator(path), {}) == 13);  // nothing touched
  {
    RunFolder run = RunFolder::open(path, FolderMode::resume);
    CHECK(run.holds_run());
    run.begin();
    CHECK(slurp(run.checkpoint()) == "checkpoint.h5");
  }
  { RunFolder run = RunFolder::open(path, FolderMode::force); }
  CHECK(std::distance(std::filesystem::directory_iterator(path), {}) == 13);  // not begun
  RunFolder run = RunFolder::open(path, FolderMode::force);
  run.begin();
  CHECK(!run.holds_run());
  CHECK(slurp(path / "notes.txt") == "notes.txt");
  CHECK(std::distance(std::filesystem::directory_iterator(path), {}) == 2);  // the notes and the lock
}

TEST_CASE("what is no folder or cannot be made") {
  const TemporaryFolder folder;
  spill(folder / "file", "x");
  CHECK(contains(refusal(folder / "file", FolderMode::force), "not a folder"));
  CHECK(contains(refusal(folder / "file/run", FolderMode::fresh), "cannot make"));
  CHECK(contains(refusal("/proc/run", FolderMode::fresh), "cannot make"));
  CHECK(contains(refusal("", FolderMode::fresh), "empty"));
  if (geteuid() != 0) {  // root may write everywhere
    std::filesystem::create_directory(folder / "closed");
    std::filesystem::permissions(folder / "closed",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    CHECK(contains(refusal(folder / "closed", FolderMode::fresh), "cannot write"));
    CHECK(contains(refusal(folder / "closed/run", FolderMode::fresh), "cannot make"));
  }
}
