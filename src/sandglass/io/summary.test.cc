#include "sandglass/io/summary.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

TEST_CASE("numbers come back with the bits they had") {
  CHECK(rc::check("double -> JSON -> double", [](std::uint64_t bits) {
    Summary summary;
    summary.temperature.small = std::bit_cast<double>(bits);
    summary.seed = bits;
    summary.errors = {{"temperature", std::bit_cast<double>(bits)}};
    const Summary again = summary_from_json(to_json(summary));
    RC_ASSERT(again.seed == bits);
    if (std::isfinite(summary.temperature.small)) {
      RC_ASSERT(std::bit_cast<std::uint64_t>(again.temperature.small) == bits);
      RC_ASSERT(again.errors == summary.errors);
    } else {
      RC_ASSERT(std::isnan(again.temperature.small));
    }
  }));
}

TEST_CASE("the file has the keys that readers rely on, and unknowns are null") {
  const TemporaryFolder folder;
  Summary summary;
  summary.version = "1.2";
  summary.momentum = {0.5, -0.25};
  summary.msd_exponent.small = {0.6163, 0.0011, 1, 10};
  summary.decisions = {"a \"quoted\"\nsentence", "bad bytes \xff"};
  summary.stationary = true;
  write_summary(folder / "summary.json", summary);
  const std::string text = slurp(folder / "summary.json");
  for (const char* key : {"version",
                          "seed",
                          "particles",
                          "packing_fraction",
                          "restitution",
                          "box_length",
                          "time",
                          "collisions",
                          "collisions_per_particle",
                          "temperature",
                          "collision_rate",
                          "compressibility_factor",
                          "kick_amplitude",
                          "kick_frequency",
                          "elastic_collision_fraction",
                          "momentum",
                          "stationary",
                          "errors",
                          "wall_seconds",
                          "collisions_per_second",
                          "state_hash"}) {
    CAPTURE(key);
    CHECK(text.find("\n  \"" + std::string(key) + "\": ") != std::string::npos);
  }
  CHECK(text.find("\"collision_rate\": null") != std::string::npos);
  CHECK(text.find("\"errors\": {}") != std::string::npos);
  const Summary again = read_summary(folder / "summary.json");
  CHECK(again.version == "1.2");
  CHECK(again.momentum == summary.momentum);
  CHECK(again.msd_exponent.small.error == 0.0011);
  CHECK(std::isnan(again.msd_exponent.big.value));
  CHECK(again.decisions[0] == summary.decisions[0]);
  CHECK(again.stationary);
  CHECK(to_json(again) == text);
}

TEST_CASE("what is no summary is bad input") {
  for (const char* text : {"", "{", "[]x", "{\"seed\": \"x\"}", "{\"momentum\": [1]}", "{\"stationary\": 1}", "null",
                           "[]", "{}", "{\"state_hash\": \"\", \"seed\": -1}",
                           "{\"state_hash\": \"\", \"seed\": 1e300}", "{\"state_hash\": \"\", \"errors\": [1]}"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(summary_from_json(text), InputError);
  }
  CHECK_THROWS_AS(read_summary("/nonexistent/summary.json"), InputError);
}
