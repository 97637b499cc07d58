#include "sandglass/study/manifest.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

/// The message with which a manifest of this text is refused; empty if it is read.
std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  spill(folder / "manifest.tsv", text);
  return message_of<InputError>([&] { read_manifest(folder / "manifest.tsv"); });
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string header = "index\tpath\tseed\tsystem.packing_fraction\n";

}  // namespace

TEST_CASE("what is written reads back, in any order and with the line ends of any editor") {
  const TemporaryFolder folder;
  const Manifest manifest{
      .folder = folder.path(),
      .axes = {"system.packing_fraction", "drive.kind"},
      .rows = {{2, "runs/b", 7, {"0.5", "\"pair\""}}, {1, "runs/a", 18446744073709551615u, {"0.7", "x"}}}};
  write_manifest(manifest_in(folder.path()), manifest);
  std::string text = slurp(manifest_in(folder.path()));
  for (const std::string end : {"\n", "\r\n"}) {
    const Manifest again = read_manifest(manifest_in(folder.path()));
    CHECK(again.axes == manifest.axes);
    REQUIRE(again.rows.size() == 2);
    CHECK(find_row(again, 1).seed == 18446744073709551615u);
    CHECK(again.run_folder(find_row(again, 2)) == folder / "runs/b");
    CHECK(find_row(again, 2).values == manifest.rows[0].values);
    CHECK(contains(message_of<InputError>([&] { find_row(again, 3); }), "from 1 to 2"));
    std::string crlf;
    for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    spill(manifest_in(folder.path()), crlf);
  }
}

TEST_CASE("a damaged or hostile manifest is refused by line and reason") {
  CHECK(refusal(header).empty());
  CHECK(refusal(header + "\n").empty());
  CHECK(contains(refusal(""), "no manifest"));
  CHECK(contains(refusal("a\tb\n"), "no manifest"));
  CHECK(contains(refusal("index\tpath\tseed\tno.such_key\n"), "no.such_key"));
  CHECK(contains(refusal(header + "1\truns/a\t1\n"), "3 columns instead of 4"));
  CHECK(contains(refusal(header + "1\truns/a\t1\t0.5\tmore\n"), "5 columns"));
  for (const char* number : {"", "-1", "x", "1.5", "1e3", " 1", "99999999999999999999"})
    CHECK(contains(refusal(header + number + "\truns/a\t1\t0.5\n"), ":2: index"));
  CHECK(contains(refusal(header + "0\truns/a\t1\t0.5\n"), "at least 1"));
  CHECK(contains(refusal(header + "1\truns/a\tx\t0.5\n"), ":2: seed"));
  for (const char* path : {"", ".", "/etc", "..", "../a", "runs/../../a", "runs/.."})
    CHECK(contains(refusal(header + "1\t" + path + "\t1\t0.5\n"), "below that of the manifest"));
  CHECK(contains(refusal(header + std::string("1\ta\0\t1\t0.5\n", 11)), "below that of the manifest"));
  CHECK(contains(refusal(header + "1\truns/a\t1\t0.5\n1\truns/b\t1\t0.5\n"), ":3: index 1 is given twice"));
  CHECK(contains(refusal(header + "1\truns/a\t1\t0.5\n2\truns/./a\t1\t0.5\n"), "given twice"));
  CHECK(contains(message_of<InputError>([] { read_manifest("/absent/manifest.tsv"); }), "cannot read"));
}

TEST_CASE("any bytes are read or refused, never worse") {
  CHECK(rc::check("arbitrary text", [](const std::string& text) {
    refusal(text);
    refusal(header + text);
    refusal(header + "1\t" + text);
  }));
}

TEST_CASE("a row and the configuration in its folder must agree") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "runs/a");
  Config config;
  spill(folder / "runs/a/config.toml", config_to_toml(config));
  Manifest manifest{.folder = folder.path(), .axes = {"system.packing_fraction"}, .rows = {{1, "runs/a", 1, {"0.8"}}}};
  CHECK(read_point(manifest, manifest.rows[0]).run.seed == 1);
  manifest.rows[0].seed = 2;
  CHECK(contains(message_of<InputError>([&] { read_point(manifest, manifest.rows[0]); }), "run.seed = 1"));
  manifest.rows[0] = {1, "runs/a", 1, {"0.7"}};
  CHECK(contains(message_of<InputError>([&] { read_point(manifest, manifest.rows[0]); }), "says 0.7"));
  manifest.rows[0].path = "runs/b";
  CHECK(contains(message_of<InputError>([&] { read_point(manifest, manifest.rows[0]); }), "config.toml"));
}
