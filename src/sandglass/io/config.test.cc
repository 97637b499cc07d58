#include "sandglass/io/config.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <rapidcheck.h>

#include <string>

#include "sandglass/core/errors.h"
#include "sandglass/io/config_table.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

Config from_text(const std::string& text, const std::vector<std::string>& assignments = {}) {
  return read_config_text(text, "test.toml", "/folder", assignments);
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Whether reading ends with an InputError that has all of `parts` in its message.
bool refused(const std::string& text, const std::vector<std::string>& assignments,
             const std::vector<std::string>& parts) {
  const std::string message = message_of<InputError>([&] { from_text(text, assignments); });
  bool good = !message.empty();
  for (const std::string& part : parts) good = good && contains(message, part);
  if (!good) MESSAGE("message was: " << message);
  return good;
}

double real(double low, double high) {
  const auto cell = *rc::gen::inRange<std::uint64_t>(0, std::uint64_t{1} << 53);
  return low + (high - low) * (static_cast<double>(cell) * 0x1p-53);
}

/// Any valid configuration that starts from `file`.
Config any_config(const std::string& file) {
  Config c;
  c.system.particles = 2 * *rc::gen::inRange<std::uint64_t>(5000, 1000000);
  c.system.packing_fraction = real(0.01, 0.45);
  c.system.size_ratio = real(1, 5);
  c.collision.restitution = real(0.1, 0.99);
  c.collision.collapse_policy = *rc::gen::element(CollapsePolicy::none, CollapsePolicy::tc);
  c.collision.collapse_time = real(0, 1);
  c.drive.kind = *rc::gen::element(DriveKind::none, DriveKind::pair, DriveKind::single);
  c.drive.partner = *rc::gen::element(PartnerRule::nearest, PartnerRule::within);
  c.drive.reach = real(1.1, 10);
  if (*rc::gen::arbitrary<bool>()) c.drive.frequency = real(1e-3, 1e6);
  c.drive.temperature = real(1e-3, 1e3);
  c.prepare.method = *rc::gen::element(PrepareMethod::quench, PrepareMethod::insert, PrepareMethod::file);
  c.prepare.jammed_fraction = real(0.5, 0.9);
  if (c.prepare.method == PrepareMethod::file) c.prepare.file = file;
  c.run.seed = *rc::gen::inRange<std::uint64_t>(0, std::uint64_t{1} << 63);
  c.run.equilibrate = real(0, 1e6);
  c.run.collisions = real(1000, 1e9);
  c.run.intervals = *rc::gen::inRange<std::uint64_t>(1, 500);
  c.run.threads = *rc::gen::inRange<std::uint64_t>(1, 64);
  c.observe.wavenumbers.clear();
  for (auto n = *rc::gen::inRange(1, 32); n > 0; --n) c.observe.wavenumbers.push_back(real(1e-3, 100));
  c.observe.lags_per_decade = real(1, 100);
  c.output.trajectory_frames = *rc::gen::inRange<std::uint64_t>(2, 1000000);
  c.output.checkpoint_seconds = real(1, 1e6);
  return c;
}

}  // namespace

TEST_CASE("defaults are valid and readable from an empty file") {
  const Config config = from_text("");
  CHECK(config.system.particles == 10000);
  CHECK(!config.drive.frequency);
  CHECK(config_to_toml(config) == config_to_toml(Config{}));
}

TEST_CASE("what is written reads back to the same bits") {
  const TemporaryFolder folder;
  // A name with everything that TOML must escape, and some UTF-8 that it must not touch.
  const std::string file = (folder / "a \"b\" \\ \t\n\x01\x7f = # é 雪").string();
  spill(file, "x");
  CHECK(rc::check("config -> TOML -> config", [&] {
    const Config config = any_config(file);
    const Config again = from_text(config_to_toml(config));
    RC_ASSERT(config_to_toml(again) == config_to_toml(config));
    RC_ASSERT(differing_keys(again, config).empty());
    RC_ASSERT(again.run.seed == config.run.seed);
    RC_ASSERT(again.system.packing_fraction == config.system.packing_fraction);
    RC_ASSERT(again.drive.frequency == config.drive.frequency);
    RC_ASSERT(again.observe.wavenumbers == config.observe.wavenumbers);
    RC_ASSERT(again.prepare.file == config.prepare.file);
    RC_ASSERT(again.prepare.method == config.prepare.method);
  }));
}

TEST_CASE("numbers may be written in any way that means the same") {
  CHECK(from_text("[system]\nparticles = 40_000").system.particles == 40000);
  CHECK(from_text("[system]\nparticles = 4e4").system.particles == 40000);
  CHECK(from_text("system.particles = 0x100").system.particles == 256);
  CHECK(from_text("[run]\nequilibrate = 7").run.equilibrate == 7);
  CHECK(from_text("[run]\nseed = 9223372036854775807").run.seed == 9223372036854775807u);
  CHECK(refused("[run]\nseed = 1e18", {}, {"test.toml:2:8", "run.seed", "write all its digits"}));
  CHECK(refused("[run]\nintervals = 1.5", {}, {"run.intervals = 1.5", "whole"}));
}

TEST_CASE("assignments act after the file, in their order") {
  const Config config = from_text("[run]\nseed = 3", {"run.seed=4", " run.seed = 7 ", "drive.kind=single",
                                                      "drive.frequency=2.5", "observe.wavenumbers=[1, 2.5]"});
  CHECK(config.run.seed == 7);
  CHECK(config.drive.kind == DriveKind::single);
  CHECK(*config.drive.frequency == 2.5);
  CHECK(config.observe.wavenumbers == std::vector<double>{1, 2.5});
  CHECK(!from_text("drive.frequency = 2", {"drive.frequency=collision"}).drive.frequency);
  CHECK(refused("", {"run.seed"}, {"--set run.seed", "no value"}));
  CHECK(refused("", {"run.sed=1"}, {"--set run.sed=1", "did you mean run.seed?"}));
  CHECK(refused("", {"run.seed=1\n[drive]"}, {"run.seed must be an integer"}));
  CHECK(refused("", {"run.seed="}, {"run.seed must be an integer"}));
}

TEST_CASE("unknown keys and sections get the nearest known one suggested") {
  CHECK(refused("[system]\npaking_fraction = 0.5", {}, {"test.toml:2:1", "did you mean system.packing_fraction?"}));
  CHECK(refused("[sytem]\nparticles = 2", {}, {"test.toml:1:2", "did you mean [system]?"}));
  CHECK(refused("restitution = 0.5", {}, {"in no section", "did you mean collision.restitution?"}));
  CHECK(refused("[run]\nrestitution = 0.5", {}, {"did you mean collision.restitution?"}));
  CHECK(refused("[run]\nxyzzy = 1", {}, {"unknown key run.xyzzy"}));
  CHECK(refused("[run.seed]\nx = 1", {}, {"run.seed must be an integer, not a table"}));
}

TEST_CASE("wrong types, words and ranges") {
  CHECK(refused("[system]\nparticles = \"many\"", {}, {"test.toml:2:13", "must be an integer", "\"many\""}));
  CHECK(refused("[system]\nparticles = 1", {}, {"out of range", "[2, 2147483648]"}));
  CHECK(refused("[system]\nparticles = -4", {}, {"out of range"}));
  CHECK(refused("[system]\npacking_fraction = nan", {}, {"out of range"}));
  CHECK(refused("[system]\npacking_fraction = inf", {}, {"out of range"}));
  CHECK(refused("[system]\npacking_fraction = 0.83", {}, {"0.82"}));
  CHECK(refused("[collision]\nrestitution = 0", {}, {"(0, 1]"}));
  CHECK(refused("[collision]\nrestitution = 1.01", {}, {"(0, 1]"}));
  CHECK(refused("[run]\nthreads = true", {}, {"not a boolean"}));
  CHECK(refused("[drive]\nkind = \"pairs\"", {}, {"\"none\", \"pair\", \"single\""}));
  CHECK(refused("[drive]\nkind = 3", {}, {"\"none\", \"pair\", \"single\""}));
  CHECK(refused("[drive]\nfrequency = \"colision\"", {}, {"\"collision\" or a number"}));
  CHECK(refused("[drive]\nfrequency = 0", {}, {"out of range"}));
  CHECK(refused("[observe]\nwavenumbers = []", {}, {"1 to 32 values"}));
  CHECK(refused("[observe]\nwavenumbers = [1, 0]", {}, {"out of range"}));
  CHECK(refused("[observe]\nwavenumbers = [1, \"a\"]", {}, {"array of numbers"}));
  CHECK(refused("[observe]\nwavenumbers = 3", {}, {"array of numbers"}));
}

TEST_CASE("what no single key can tell") {
  CHECK(refused("system.particles = 10001", {}, {"is odd"}));
  CHECK(refused("system.big_fraction = 0.33333", {}, {"whole number of disks"}));
  CHECK(from_text("system.big_fraction = 0.3").system.big_fraction == 0.3);
  CHECK(from_text("system.big_fraction = 0\nsystem.particles = 10001").system.particles == 10001);
  CHECK(refused("collision.restitution = 1", {}, {"no steady state", "drive.kind = \"none\""}));
  CHECK(from_text("collision.restitution = 1\ndrive.kind = \"none\"").collision.restitution == 1);
  CHECK(refused("prepare.method = \"insert\"", {}, {"0.45", "quench"}));
  CHECK(refused("system.packing_fraction = 0.005", {}, {"insert"}));
  CHECK(refused("prepare.jammed_fraction = 0.8", {}, {"must be above"}));
  CHECK(refused("run.intervals = 11\nrun.collisions = 10.5", {}, {"at most 5"}));
  CHECK(refused("output.trajectory_frames = 1", {}, {"0 (no file) or at least 2"}));
}

TEST_CASE("the least number of disks that is named is accepted, the next lower one is not") {
  const std::string message = message_of<InputError>([] { from_text("system.particles = 2"); });
  const std::size_t at = message.find("at least ");
  REQUIRE(at != std::string::npos);
  const auto least = std::stoul(message.substr(at + 9));
  CHECK(from_text(fmt::format("system.particles = {}", least)).system.particles == least);
  CHECK(refused(fmt::format("system.particles = {}", least - 2), {}, {"too small"}));
}

TEST_CASE("start files: relative to the configuration's folder, on the command line to the working folder") {
  const TemporaryFolder folder;
  spill(folder / "start.h5", "x");
  spill(folder / "run.toml", "[prepare]\nmethod = \"file\"\nfile = \"start.h5\"\n");
  CHECK(read_config(folder / "run.toml").prepare.file == (folder / "start.h5").string());
  CHECK(refused("", {"prepare.method=file"}, {"needs prepare.file"}));
  CHECK(refused("prepare.file = \"a.h5\"", {}, {"prepare.method = \"file\""}));
  CHECK(refused("", {"prepare.method=file", "prepare.file=\xff\xfe"}, {"UTF-8"}));
}

TEST_CASE("files that cannot be read or parsed") {
  const TemporaryFolder folder;
  spill(folder / "bad.toml", "[system]\nparticles = = 3\n");
  const auto message = [&](const std::filesystem::path& path) {
    return message_of<InputError>([&] { read_config(path); });
  };
  CHECK(contains(message(folder / "bad.toml"), "bad.toml:2:13"));
  CHECK(contains(message(folder / "absent.toml"), "No such file"));
  CHECK(contains(message(folder.path()), "folder"));
  spill(folder / "long.toml", std::string(2 << 20, '#'));
  CHECK(contains(message(folder / "long.toml"), "longer"));
  spill(folder / "deep.toml", std::string("x = ").append(100000, '['));
  CHECK(contains(message(folder / "deep.toml"), "not TOML"));
}

TEST_CASE("any bytes are read or refused, never worse") {
  CHECK(rc::check("arbitrary text", [](const std::string& text) {
    const auto attempt = [&](const std::string& toml, const std::vector<std::string>& set) {
      try {
        from_text(toml, set);
      } catch (const InputError&) {
      }
    };
    attempt(text, {});
    attempt("[system]\nparticles = " + text, {});
    attempt("", {"prepare.file=" + text});
    attempt("", {text});
  }));
}

TEST_CASE("only threads and checkpoint settings may differ when a run is resumed") {
  Config a, b;
  b.run.threads = 8;
  b.output.checkpoint_seconds = 1;
  CHECK(differing_keys(a, b).empty());
  b.run.seed = 2;
  b.drive.frequency = 3;
  CHECK(differing_keys(a, b) == std::vector<std::string>{"drive.frequency", "run.seed"});
}

TEST_CASE("reference and complete configuration name every key") {
  const std::string reference = config_reference(), toml = config_to_toml(Config{});
  for (const Key& key : config_table()) {
    CHECK(contains(reference, fmt::format("`{}`", key.name)));
    CHECK(contains(toml, fmt::format("\n{} = ", key.leaf())));
    CHECK(!key.description.empty());
  }
}
