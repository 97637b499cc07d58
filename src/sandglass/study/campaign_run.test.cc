#include "sandglass/study/campaign_run.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "sandglass/io/run_folder.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/study/campaign.h"

using namespace sandglass;

namespace {

/// A campaign of three points, the longest last, and a program that plays the runs.
struct Stage {
  TemporaryFolder folder;
  std::filesystem::path program = folder / "program", calls = folder / "calls";

  /// `script` is what the program does, in the folder of its point, a folder of runs/.
  explicit Stage(const std::string& script) {
    const std::string study =
        "[[sweep.zip]]\nsystem.packing_fraction = [0.5, 0.6, 0.7]\nrun.collisions = [1e4, 1e5, 1e6]";
    write_campaign(plan_campaign(read_study_text(study, "study.toml", "/folder"), folder.path()), study);
    spill(program,
          fmt::format("#!/bin/sh\necho $5 >> '{}'\nindex=$5\ncd '{}'/runs\nset -- x *\nshift $index\ncd \"$1\"\n"
                      "finish() {{ echo '{{}}' > summary.json; touch report.html; }}\n{}\n",
                      calls.string(), folder.path().string(), script));
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  }
  CampaignResult run(std::size_t jobs, const CampaignMonitor& monitor = {}) const {
    return run_campaign(manifest_in(folder.path()), jobs, monitor, program.string());
  }
  [[nodiscard]] std::string called() const {
    std::string order = slurp(calls);
    std::erase(order, '\n');
    return order;
  }
};

}  // namespace

TEST_CASE("every point is run once, the longest first, and not again when it is done") {
  const Stage stage("finish");
  CHECK(stage.run(1).progress.done == 3);
  CHECK(stage.called() == "321");
  const CampaignResult again = stage.run(2);
  CHECK(again.progress.done == 3);
  CHECK(again.progress.fraction == 1);
  CHECK(stage.called() == "321");
}

TEST_CASE("a failed point is named with the last line of what it printed, and the others go on") {
  const Stage stage(
      "case $PWD in *eta=0.60*) echo first; echo 'it cannot be' >&2; exit 2;; *eta=0.70*) kill -SEGV $$;; esac\n"
      "finish");
  std::vector<std::string> messages;
  CampaignResult result = stage.run(
      2, {.progress = {}, .message = [&](const std::string& text) { messages.push_back(text); }, .stop_requested = {}});
  CHECK(result.progress.done == 1);
  REQUIRE(result.failed.size() == 2);
  std::sort(result.failed.begin(), result.failed.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  CHECK(result.failed[0].index == 2);
  CHECK(result.failed[0].reason == "it cannot be");
  CHECK(result.failed[1].reason.find("signal 11") != std::string::npos);
  REQUIRE(messages.size() == 2);
  CHECK((messages[0] + messages[1]).find("output.log") != std::string::npos);
}

TEST_CASE("a point that was killed or stopped is started again while it gets further") {
  SUBCASE("killed once") {
    const Stage stage("case $PWD in *eta=0.60*) if [ ! -e tried ]; then touch tried; kill -9 $$; fi;; esac\nfinish");
    const CampaignResult result = stage.run(1);
    CHECK(result.failed.empty());
    CHECK(stage.called() == "3221");
  }
  SUBCASE("stopped often, with checkpoints") {
    const Stage stage(
        "case $PWD in *eta=0.60*) echo x >> checkpoint.h5; sleep 0.02; "
        "[ $(wc -l < checkpoint.h5) -gt 6 ] || exit 75;; esac\nfinish");
    const CampaignResult result = stage.run(1);
    CHECK(result.failed.empty());
    CHECK(stage.called() == "322222221");
  }
  SUBCASE("without getting anywhere") {
    const Stage stage("case $PWD in *eta=0.60*) exit 75;; esac\nfinish");
    const CampaignResult result = stage.run(1);
    REQUIRE(result.failed.size() == 1);
    CHECK(result.failed[0].reason.find("without getting further") != std::string::npos);
    CHECK(stage.called() == "32221");
  }
}

TEST_CASE("when asked to stop it stops what runs and starts nothing more") {
  const Stage stage("trap 'exit 75' TERM\ntouch started\nfor i in $(seq 500); do sleep 0.02; done");
  const CampaignResult result =
      stage.run(2, {.progress = {}, .message = {}, .stop_requested = [&] {
                      return std::filesystem::exists(stage.folder / "runs/eta=0.70_collisions=1000000_seed=1/started");
                    }});
  CHECK(result.stopped);
  CHECK(result.progress.done == 0);
  CHECK(result.failed.empty());
  CHECK(stage.called().find('1') == std::string::npos);
}

TEST_CASE("a point of another process is waited for") {
  const Stage stage("finish");
  std::optional<RunFolder> held =
      RunFolder::open(stage.folder / "runs/eta=0.60_collisions=0100000_seed=1", FolderMode::resume);
  std::size_t seen = 0;
  const CampaignResult result = stage.run(1, {.progress =
                                                  [&](const CampaignProgress& progress) {
                                                    seen = std::max(seen, progress.elsewhere);
                                                    if (progress.done + progress.failed == 2) held.reset();
                                                  },
                                              .message = {},
                                              .stop_requested = {}});
  CHECK(seen == 1);
  CHECK(result.progress.done == 3);
  CHECK(stage.called() == "312");
}

TEST_CASE("a point that another process has finished meanwhile is done") {
  const Stage stage("finish\necho 'in use by another run' >&2\ncase $PWD in *eta=0.60*) exit 2;; esac");
  const CampaignResult result = stage.run(2);
  CHECK(result.failed.empty());
  CHECK(result.progress.done == 3);
}

TEST_CASE("there is a core") { CHECK(usable_cores() >= 1); }
