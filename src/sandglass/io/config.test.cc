#include "sandglass/io/config.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <rapidcheck.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
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
  c.observe.exponent_from = real(1e-3, 5);
  c.observe.exponent_to = real(6, 1e6);
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

TEST_CASE("assignments say the same in any order, and the last one of a key counts") {
  CHECK(rc::check("order of assignments", [] {
    const Config config = any_config("start.h5");
    // In the shape of "key=value", from the complete configuration: all keys, so that any order is a whole one.
    std::vector<std::string> assignments;
    for (const Key& key : config_table()) assignments.push_back(fmt::format("{}={}", key.name, key.write(config, key)));
    std::vector<std::string> shuffled = assignments;
    for (std::size_t i = shuffled.size(); i > 1; --i)
      std::swap(shuffled[i - 1], shuffled[*rc::gen::inRange<std::size_t>(0, i)]);
    const Key& earlier = config_table()[*rc::gen::inRange<std::size_t>(0, config_table().size())];
    shuffled.insert(shuffled.begin(), fmt::format("{}={}", earlier.name, earlier.write(Config{}, earlier)));
    const std::string expected = config_to_toml(from_text("", assignments));
    RC_ASSERT(config_to_toml(from_text("", shuffled)) == expected);
    // Assigning a file's text is as reading it, but for what its paths are relative to.
    if (config.prepare.method != PrepareMethod::file)
      RC_ASSERT(config_to_toml(from_text(config_to_toml(config))) == expected);
  }));
}

TEST_CASE("configurations differ in the keys in which they were made to differ, either way round") {
  CHECK(rc::check("differing keys", [] {
    const Config a = any_config("start.h5"), b = any_config("start.h5");
    const auto names = differing_keys(a, b);
    RC_ASSERT(names == differing_keys(b, a));
    RC_ASSERT(differing_keys(a, a).empty());
    const std::string toml_a = config_to_toml(a), toml_b = config_to_toml(b);
    for (const Key& key : config_table()) {
      const bool differs = key.write(a, key) != key.write(b, key);
      const bool named = std::find(names.begin(), names.end(), key.name) != names.end();
      RC_ASSERT(named == (differs && key.physics));
    }
    if (toml_a == toml_b) RC_ASSERT(names.empty());
  }));
}

TEST_CASE("a number at the end of its range is accepted, the next one beyond is not") {
  for (const Key& key : config_table()) {
    const bool whole = key.type == "integer", list = key.type == "array of numbers";
    if (!whole && !list && !key.type.starts_with("number")) continue;
    CAPTURE(key.name);
    // (What another key limits further is refused by another message.)
    const auto out_of_range = [&](const std::string& number) {
      const std::string value = list ? "[" + number + "]" : number;
      return contains(message_of<InputError>([&] { from_text("", {fmt::format("{}={}", key.name, value)}); }),
                      "out of range");
    };
    const auto text = [&](double x) {
      return fmt::format(whole ? fmt::runtime("{:.0f}") : fmt::runtime("{:.17e}"), x);
    };
    const auto beside = [&](double x, double to) { return whole ? x + std::copysign(1, to) : std::nextafter(x, to); };
    const auto [low, high, open] = key.range;
    CHECK(out_of_range(text(open ? low : beside(low, -Range::infinity))));
    CHECK(!out_of_range(text(open ? beside(low, Range::infinity) : low)));
    const bool can_exceed = high < (whole ? 0x1p53 : Range::infinity);  // 2^63 is also the end of TOML's integers
    if (can_exceed) CHECK(out_of_range(text(beside(high, Range::infinity))));
    CHECK(!out_of_range(text(std::min(high, 0x1p53))));
    for (const char* never : {"nan", "inf", "-inf", "-1e308"}) CHECK(out_of_range(never));
  }
}

TEST_CASE("any unknown key is refused by its name") {
  CHECK(rc::check("unknown keys", [] {
    const auto letters = *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::inRange('a', 'z')));
    for (const std::string& name : {letters, "run." + letters, letters + ".seed", "run.seed." + letters}) {
      const bool known =
          std::any_of(config_table().begin(), config_table().end(), [&](const Key& key) { return key.name == name; });
      if (known) continue;
      RC_ASSERT(contains(message_of<InputError>([&] { from_text("", {name + "=1"}); }), "unknown key " + name));
      // In a file "run.seed.x" is a table in the place of a number.
      RC_ASSERT(!message_of<InputError>([&] { from_text(name + " = 1"); }).empty());
    }
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

TEST_CASE("partners beyond half the box, restitutions next to 1, a path with a null character") {
  CHECK(refused("drive.partner = \"within\"", {"drive.reach=999"}, {"drive.reach = 999", "at most"}));
  CHECK(from_text("drive.reach = 999").drive.reach == 999);  // not used
  CHECK(refused("collision.restitution = 0.9995", {}, {"0.9995", "at most 0.999"}));
  CHECK(refused("prepare.file = \"a\\u0000b\"", {"prepare.method=file"}, {"test.toml:1", "null character"}));
}

TEST_CASE("wavenumbers that the box holds too many waves of") {
  CHECK(refused("observe.wavenumbers = [1, 1e4]", {"system.particles=4000000"}, {"observe.wavenumbers", "at most"}));
  CHECK(from_text("observe.wavenumbers = [1, 50]", {"system.particles=4000000"}).observe.wavenumbers[1] == 50);
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
  // A dotted key nests without a limit of the library's, which frees what it made by recursion.
  std::string dotted;
  for (int i = 0; i < 200000; ++i) dotted += "a.";
  spill(folder / "dotted.toml", dotted + "a = 1");
  CHECK(contains(message(folder / "dotted.toml"), "dots"));
  spill(folder / "dotted.toml", "[" + dotted + "a]");
  CHECK(contains(message(folder / "dotted.toml"), "dots"));
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK(contains(message(folder / "pipe"), "pipe"));
  CHECK(contains(message("/dev/zero"), "device"));
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
    // Bytes that look more like a configuration.
    std::string near = config_to_toml(Config{});
    for (auto edits = *rc::gen::inRange(1, 6); edits > 0; --edits) {
      const auto at = *rc::gen::inRange<std::size_t>(0, near.size());
      near.replace(at, *rc::gen::inRange<std::size_t>(0, 3),
                   *rc::gen::element<std::string>("=", "\"", "[", "-", "9e9", "\n", "nan", "\xff", text));
    }
    attempt(near, {});
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
