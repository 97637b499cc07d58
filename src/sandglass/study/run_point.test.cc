#include "sandglass/study/run_point.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <string_view>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

Config tiny() {
  Config config;
  config.system.particles = 100;
  config.system.packing_fraction = 0.4;
  config.prepare.method = PrepareMethod::insert;
  config.collision.restitution = 0.5;
  config.run.equilibrate = 20;
  config.run.collisions = 100;
  config.run.intervals = 5;
  config.output.trajectory_frames = 3;
  return config;
}

Summary run(const Config& config, const std::filesystem::path& path) {
  RunFolder folder = RunFolder::open(path, FolderMode::fresh);
  return run_point(config, folder, false).summary;
}

}  // namespace

TEST_CASE("a run leaves all its files and a summary that adds up") {
  const TemporaryFolder scratch;
  const Summary s = run(tiny(), scratch / "a");
  for (const char* name :
       {"config.toml", "summary.json", "observables.h5", "trajectory.h5", "checkpoint.h5", "run.log"})
    CHECK(std::filesystem::exists(scratch / "a" / name));
  CHECK(s.collisions_per_particle > 90);
  CHECK(s.collision_rate * s.time == doctest::Approx(s.collisions_per_particle).epsilon(1e-9));
  // Injected, dissipated and kinetic energies come from different sums; their quantum is 6e-14, some 1e4 terms.
  CHECK(std::fabs(s.energy.balance) < 1e-10);
  CHECK(std::fabs(s.momentum[0]) < 1e-10);
  CHECK(s.state_hash.size() == 16);
}

TEST_CASE("the sampling plan does not change the trajectory, the seed does") {
  const TemporaryFolder scratch;
  const std::string hash = run(tiny(), scratch / "a").state_hash;
  Config other = tiny();
  other.observe.wavenumbers = {2.0};
  other.output.trajectory_frames = 0;
  other.run.seed = 2;
  CHECK(run(other, scratch / "b").state_hash != hash);
  other.run.seed = 1;
  for (const std::uint64_t intervals : {1, 2, 3, 7, 9, 10, 11, 13, 23, 49}) {
    other.run.intervals = intervals;
    CHECK(run(other, scratch / std::to_string(intervals)).state_hash == hash);
  }
}

TEST_CASE("a run asked to stop before it runs leaves nothing that hinders a start") {
  const TemporaryFolder scratch;
  for (const char* when : {"inserting", "calibrating"}) {
    RunFolder folder = RunFolder::open(scratch / "a", FolderMode::resume);
    bool now = false;
    const RunMonitor monitor{.progress = [&](std::string_view stage, double) { now |= stage.starts_with(when); },
                             .stop_requested = [&] { return now; }};
    CHECK(run_point(tiny(), folder, true, monitor).outcome == RunOutcome::stopped);
  }
  RunFolder folder = RunFolder::open(scratch / "a", FolderMode::resume);
  CHECK(run_point(tiny(), folder, true).summary.state_hash == run(tiny(), scratch / "b").state_hash);
}

TEST_CASE("a run stopped anywhere and resumed ends in the same bits of state, observables and trajectory") {
  for (const DriveKind kind : {DriveKind::pair, DriveKind::single, DriveKind::none}) {
    const TemporaryFolder scratch;
    Config config = tiny();
    config.drive.kind = kind;
    const Summary whole = run(config, scratch / "whole");
    int stops = 0;
    for (int beats = 1;; beats = beats * 3 / 2 + 1) {
      RunFolder folder = RunFolder::open(scratch / "cut", FolderMode::resume);
      int left = beats;
      bool running = false;  // the preparation, when stopped, starts anew: not what is tested here
      const RunMonitor monitor{
          .progress = [&](std::string_view stage, double) { running |= !stage.starts_with("inserting"); },
          .stop_requested = [&] { return running && left-- <= 0; }};
      const RunResult result = run_point(config, folder, true, monitor);
      if (result.outcome == RunOutcome::stopped) {
        ++stops;
        continue;
      }
      CHECK(result.outcome == RunOutcome::finished);
      CHECK(result.summary.state_hash == whole.state_hash);
      break;
    }
    CHECK(stops > 3);
    CHECK(slurp(scratch / "cut" / "observables.h5") == slurp(scratch / "whole" / "observables.h5"));
    CHECK(slurp(scratch / "cut" / "trajectory.h5") == slurp(scratch / "whole" / "trajectory.h5"));

    RunFolder folder = RunFolder::open(scratch / "cut", FolderMode::resume);
    CHECK(run_point(config, folder, true).outcome == RunOutcome::already_finished);
    config.run.seed = 99;
    CHECK_THROWS_AS(run_point(config, folder, true), InputError);
  }
}

TEST_CASE("an aged state of another run can be the start, at another density and restitution") {
  const TemporaryFolder scratch;
  run(tiny(), scratch / "a");
  Config next = tiny();
  next.prepare.method = PrepareMethod::file;
  next.prepare.file = (scratch / "a" / "checkpoint.h5").string();
  next.system.packing_fraction = 0.3;
  next.collision.restitution = 0.6;
  const Summary s = run(next, scratch / "b");
  CHECK(s.packing_fraction == doctest::Approx(0.3).epsilon(1e-12));
  next.system.particles = 102;
  CHECK_THROWS_AS(run(next, scratch / "c"), InputError);
  CHECK(!std::filesystem::exists(scratch / "c"));
}
