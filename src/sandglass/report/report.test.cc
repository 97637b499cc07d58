#include "sandglass/report/report.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "sandglass/core/errors.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/config.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/report/synthetic_run.test.h"
#include "sandglass/study/results.h"

namespace sandglass {

TEST_CASE("a whole run folder makes a whole page") {
  const TemporaryFolder folder;
  write_summary(folder / "summary.json", synthetic_summary());
  write_observables(folder / "observables.h5", synthetic_results());
  write_checkpoint(folder / "checkpoint.h5", synthetic_state(100), "", {});
  spill(folder / "config.toml", config_to_toml(Config{}));
  write_report(folder.path());
  const std::string html = slurp(folder / "report.html");
  CHECK(html.ends_with("</html>\n"));
  CHECK(html.find("0123456789abcdef") != std::string::npos);
  CHECK(html.find("system.packing_fraction") != std::string::npos);
  CHECK(html.find("The results hold no ") == std::string::npos);
  CHECK(html.find("\"packing\":{") != std::string::npos);
}

TEST_CASE("results come back from their file bit by bit") {
  const TemporaryFolder folder;
  const auto written = synthetic_results();
  write_observables(folder / "observables.h5", written);
  const auto read = read_results(folder / "observables.h5");
  CHECK(read.size() == written.size());
  for (const Dataset& dataset : read) {
    const auto same =
        std::find_if(written.begin(), written.end(), [&](const Dataset& d) { return d.path == dataset.path; });
    REQUIRE(same != written.end());
    CHECK(same->values == dataset.values);
  }
}

TEST_CASE("a folder that lacks files makes a page that says which") {
  const TemporaryFolder folder;
  write_summary(folder / "summary.json", synthetic_summary());
  spill(folder / "observables.h5", "this is no HDF5 file");
  write_report(folder.path());
  const std::string html = slurp(folder / "report.html");
  CHECK(html.find("observables.h5") != std::string::npos);
  CHECK(html.find("checkpoint") != std::string::npos);
}

TEST_CASE("without a summary there is no page") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(write_report(folder.path()), InputError);
  CHECK(!std::filesystem::exists(folder / "report.html"));
}

}  // namespace sandglass
