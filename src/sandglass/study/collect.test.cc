#include "sandglass/study/collect.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "sandglass/core/errors.h"
#include "sandglass/io/hdf5.h"
#include "sandglass/io/observables.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

namespace fs = std::filesystem;

struct Point {
  double packing_fraction = 0.5, restitution = 0.9;
  std::uint64_t seed = 1;
  double rate = 1.5, length = 100;
};

/// A finished run with a collision rate and three lags of an MSD.
void make_run(const fs::path& folder, const Point& point, const std::vector<std::string>& set = {}) {
  fs::create_directories(folder);
  Config config = read_config({}, set);
  config.system.packing_fraction = point.packing_fraction;
  config.collision.restitution = point.restitution;
  config.run.seed = point.seed;
  spill(folder / "config.toml", config_to_toml(config));
  Summary summary;
  summary.seed = point.seed, summary.packing_fraction = point.packing_fraction;
  summary.collisions_per_particle = point.length, summary.collision_rate = point.rate;
  summary.errors = {{"collision_rate", 0.01}};
  write_summary(folder / "summary.json", summary);
  const std::string group = "/dynamics/small/mean_square_displacement/";
  write_observables(folder / "observables.h5", {{group + "time", {3}, std::vector{0.1, 1.0, 10.0}, "t"},
                                                {group + "value", {3}, std::vector{0.01, 0.5, point.rate}, "R_s^2"}});
}

}  // namespace

TEST_CASE("runs are grouped into state points; replicas merged, weighted by length") {
  const TemporaryFolder folder;
  make_run(folder / "runs/a", {.seed = 1, .rate = 1, .length = 100});
  make_run(folder / "runs/b", {.seed = 2, .rate = 2, .length = 300});
  make_run(folder / "runs/deep/down/c", {.restitution = 0.7});
  const Study study = read_study(folder.path());
  REQUIRE(study.points.size() == 2);
  CHECK(study.absent.empty());
  CHECK(study.axes.empty());
  CHECK(study.points[0].restitution() == 0.7);
  const StatePoint& point = study.points[1];
  REQUIRE(point.replicas.size() == 2);
  CHECK(point.replicas[0].path == "runs/a");
  CHECK(point.length() == 400);
  CHECK(point.name == "eta=0.5_eps=0.9_N=10000");
  // (100 * 1 + 300 * 2) / 400 = 1.75; between: sqrt(2 ((100 * 0.75)^2 + (300 * 0.25)^2)) / 400 = 150 / 400
  CHECK(point.number("collision_rate").value == doctest::Approx(1.75));
  CHECK(point.number("collision_rate").error == doctest::Approx(0.375));
  CHECK(numbers_of(point.results, "/dynamics/small/mean_square_displacement/value")[2] == doctest::Approx(1.75));
}

TEST_CASE("another physics key makes another state point, and is named") {
  const TemporaryFolder folder;
  make_run(folder / "a", {});
  make_run(folder / "b", {.seed = 2}, {"drive.partner=within"});
  const Study study = read_study(folder.path());
  CHECK(study.points.size() == 2);
  CHECK(study.axes == std::vector<std::string>{"drive.partner"});
  CHECK(study.points[0].name != study.points[1].name);
}

TEST_CASE("a single run is a study of one point") {
  const TemporaryFolder folder;
  make_run(folder.path(), {});
  const Study study = read_study(folder.path());
  REQUIRE(study.points.size() == 1);
  CHECK(study.points[0].replicas[0].path == ".");
}

TEST_CASE("what is missing, unfinished or damaged is named and passed over") {
  const TemporaryFolder folder;
  make_run(folder / "runs/good", {});
  make_run(folder / "runs/damaged", {.seed = 2});
  spill(folder / "runs/damaged/observables.h5", "no HDF5");
  make_run(folder / "runs/unfinished", {.seed = 3});
  fs::remove(folder / "runs/unfinished/summary.json");
  spill(folder / "runs/unfinished/checkpoint.h5", "");
  make_run(folder / "runs/odd", {.seed = 4});
  spill(folder / "runs/odd/config.toml", "[system]\nparticles = \"many\"\n");
  spill(folder / "manifest.tsv",
        "index\tpath\tseed\n1\truns/good\t1\n2\truns/damaged\t2\n3\truns/unfinished\t3\n4\truns/never\t4\n");
  const Study study = read_study(folder.path());
  REQUIRE(study.points.size() == 1);
  CHECK(study.points[0].replicas.size() == 1);
  REQUIRE(study.absent.size() == 4);
  CHECK(study.absent[0].path == "runs/damaged");
  CHECK(study.absent[0].why.find("observables.h5") != std::string::npos);
  CHECK(study.absent[1].path == "runs/never");
  CHECK(study.absent[1].why == "not started");
  CHECK(study.absent[2].path == "runs/odd");
  CHECK(study.absent[2].why.find("particles") != std::string::npos);
  CHECK(study.absent[3].why.starts_with("not finished"));
  CHECK(describe_absent(study).ends_with(": not finished: run --resume goes on\n"));
  Study many;
  many.absent.assign(25, {"runs/x", "not started"});
  CHECK(std::ranges::count(describe_absent(many), '\n') == 11);
  CHECK(describe_absent(many).find("15 more") != std::string::npos);
}

TEST_CASE("a start file that is gone since does not matter") {
  const TemporaryFolder folder;
  make_run(folder / "a", {.packing_fraction = 0.8});
  const std::string text = slurp(folder / "a/config.toml");
  const std::size_t method = text.find("\"quench\""), file = text.find("\nfile = \"\"");
  REQUIRE(method != text.npos);
  REQUIRE(file != text.npos);
  std::string changed = text;
  changed.replace(file, 10, "\nfile = \"/gone/start.h5\"");
  changed.replace(changed.find("\"quench\""), 8, "\"file\"");
  spill(folder / "a/config.toml", changed);
  const Study study = read_study(folder.path());
  REQUIRE(study.points.size() == 1);
  CHECK(study.points[0].config.prepare.method == PrepareMethod::file);
}

TEST_CASE("nothing to collect is bad input") {
  const TemporaryFolder folder;
  CHECK(message_of<InputError>([&] { read_study(folder.path()); }).find("no run") != std::string::npos);
  CHECK_THROWS_AS(read_study(folder / "nowhere"), InputError);
  make_run(folder / "a", {});
  spill(folder / "manifest.tsv", "a\tb\n1\t2\n");
  CHECK(message_of<InputError>([&] { read_study(folder.path()); }).find("path") != std::string::npos);
}

TEST_CASE("study.h5 and the CSV files hold the merged numbers") {
  const TemporaryFolder folder;
  make_run(folder / "a", {.rate = 1});
  make_run(folder / "b", {.seed = 2, .rate = 2});
  make_run(folder / "c", {.packing_fraction = 0.6, .rate = 4});
  collect_study(folder.path());
  const Hdf5File file = Hdf5File::open(folder / "study.h5");
  CHECK(file.read<double>("/table/packing_fraction", {2}) == std::vector{0.5, 0.6});
  CHECK(file.read<double>("/table/collision_rate/value", {2}) == std::vector{1.5, 4.0});
  CHECK(file.read<double>("/points/eta=0.6_eps=0.9_N=10000/dynamics/small/mean_square_displacement/value", {3})[2] ==
        4);
  CHECK(file.read_text("/table/points", 1000) == "eta=0.5_eps=0.9_N=10000\neta=0.6_eps=0.9_N=10000\n");
  const std::string csv = slurp(folder / "csv/mean_square_displacement.csv");
  CHECK(csv.find("\neta=0.5_eps=0.9_N=10000,0.5,0.9,10000,small,10,,1.5,0.5,\n") != std::string::npos);
  CHECK(slurp(folder / "csv/points.csv").find("collision_rate,collision_rate_error") != std::string::npos);
  CHECK(slurp(folder / "csv/runs.csv").find("\nb,eta=0.5_eps=0.9_N=10000,2,100,no,\n") != std::string::npos);
}

}  // namespace sandglass
