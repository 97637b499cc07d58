#include "sandglass/io/checkpoint.h"

#include <doctest/doctest.h>

#include "sandglass/core/errors.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/state_file.h"
#include "sandglass/io/temporary_folder.h"

using namespace sandglass;

namespace {

/// One accumulator with a field of every type.
struct Accumulator {
  double last = 0;
  std::uint64_t count = 0;
  std::vector<double> times;
  std::vector<std::uint64_t> counts;
  std::vector<ExactSum> sums;

  std::vector<FieldGroup> groups() {
    return {{"observers/msd",
             {{"last", &last}, {"count", &count}, {"times", &times}, {"counts", &counts}, {"sums", &sums}}}};
  }
  friend bool operator==(const Accumulator&, const Accumulator&) = default;
};

Accumulator sample_accumulator() {
  Accumulator a{-std::numeric_limits<double>::infinity(), 1u << 31, {0.1, 0.2, 1e300}, {}, std::vector<ExactSum>(2)};
  a.sums[0].add(-1e20);
  a.sums[1].add(0.1);
  return a;
}

void save(const std::filesystem::path& path, std::uint64_t seed, Accumulator& accumulator) {
  write_checkpoint(path, sample_state(20, seed), "[run]\nseed = 1\n", accumulator.groups());
}

}  // namespace

TEST_CASE("a checkpoint restores state, configuration and accumulators") {
  const TemporaryFolder folder;
  Accumulator written = sample_accumulator(), restored;
  CHECK(!has_checkpoint(folder / "checkpoint.h5"));
  save(folder / "checkpoint.h5", 1, written);
  CHECK(has_checkpoint(folder / "checkpoint.h5"));
  const Checkpoint checkpoint = read_checkpoint(folder / "checkpoint.h5", restored.groups());
  CHECK(restored == written);
  CHECK(state_hash(checkpoint.state) == state_hash(sample_state(20)));
  CHECK(checkpoint.config_toml == "[run]\nseed = 1\n");
  CHECK(!checkpoint.from_previous);
  CHECK(state_hash(read_start_file(folder / "checkpoint.h5")) == state_hash(checkpoint.state));

  Accumulator allocated;
  allocated.times.resize(3), allocated.sums.resize(2);
  read_checkpoint(folder / "checkpoint.h5", allocated.groups());
  CHECK(allocated == written);
  allocated.times.resize(4);
  CHECK_THROWS_AS(read_checkpoint(folder / "checkpoint.h5", allocated.groups()), InputError);
  double other = 0;
  CHECK_THROWS_AS(read_checkpoint(folder / "checkpoint.h5", {{"observers/vacf", {{"last", &other}}}}), InputError);
}

TEST_CASE("truncated or flipped anywhere, a checkpoint is refused and the previous one taken") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "checkpoint.h5";
  Accumulator older = sample_accumulator(), newer = sample_accumulator();
  newer.count = 5;
  save(path, 1, older);
  save(path, 2, newer);
  const std::string whole = slurp(path);
  CHECK(read_checkpoint(path, {}).state.seed == 2);
  const auto falls_back = [&](const std::string& damaged) {
    spill(path, damaged);
    Accumulator restored;
    const Checkpoint checkpoint = read_checkpoint(path, restored.groups());
    return checkpoint.from_previous && checkpoint.state.seed == 1 && restored == older;
  };
  for (std::size_t i = 0; i < 100; ++i) {
    const std::size_t at = i * (whole.size() - 1) / 99;
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (i % 8)));
    CAPTURE(at);
    CHECK(falls_back(flipped));
    CHECK(falls_back(whole.substr(0, at)));
  }
  CHECK(falls_back(whole + 'x'));
  std::filesystem::remove(path);  // killed between the two renames
  CHECK(has_checkpoint(path));
  CHECK(read_checkpoint(path, {}).state.seed == 1);
  spill(path, whole);
  CHECK(read_checkpoint(path, {}).state.seed == 2);
  spill(path, "x");
  spill(previous_checkpoint(path), "y");
  const std::string message = message_of<InputError>([&] { read_checkpoint(path, {}); });
  CHECK(message.find("checkpoint.h5") != std::string::npos);
  CHECK(message.find("checkpoint.previous.h5") != std::string::npos);
}
