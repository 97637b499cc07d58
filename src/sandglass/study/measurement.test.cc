#include "sandglass/study/measurement.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/temporary_folder.h"
#include "sandglass/study/small_measurement.test.h"

using namespace sandglass;

namespace {

/// Restores a checkpoint of a begun measurement as a resumed run does, with one field of it changed to `value` on the
/// way; what is said against it.
template <class T>
std::string complaint(const std::string& group, const std::string& field, T value, double now = 0) {
  const TemporaryFolder folder;
  const auto path = folder / "checkpoint.h5";
  const State state = sample_state(5);
  Measurement measurement(state, small_beat);
  measurement.begin(small_plan(state), state.tally);
  std::vector<FieldGroup> stored = measurement.fields();
  stored.push_back(measurement.plan_fields());
  for (auto& [name, fields] : stored) {
    for (Field& candidate : fields) {
      if (name == group && candidate.name == field) candidate.target = &value;
    }
  }
  write_checkpoint(path, state, "", stored);

  return message_of<InputError>([&] {
    Measurement restored(state, small_beat);
    const Checkpoint checkpoint = read_checkpoint(path, {restored.plan_fields()});
    restored.prepare_restore(true, small_config());
    restore_fields(checkpoint, restored.fields());
    restored.finish_restore(now);
  });
}

}  // namespace

TEST_CASE("a checkpoint that stands where no measurement can is refused before it is followed there") {
  constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  CHECK(complaint<std::uint64_t>("correlator", "interval", 0) == "");
  for (const std::uint64_t value : {std::uint64_t{3}, none}) {
    CAPTURE(value);
    CHECK(complaint("correlator", "interval", value) != "");
    CHECK(complaint("averages", "interval", value) != "");
  }
  CHECK(complaint("correlator", "due", none) != "");
  CHECK(complaint("averages", "taken", none) != "");
  CHECK(complaint("structure", "taken", none) != "");
  CHECK(complaint("timeseries", "next", none) != "");
  CHECK(complaint<std::uint64_t>("timeseries", "runs", 0) != "");
  CHECK(complaint("tallies", "counts", std::vector<std::uint64_t>(10)) != "");
  CHECK(complaint("tallies", "counts", std::vector<std::uint64_t>()) != "");
  // At the time of the state, what the time series was to see from t = 0 on is missed.
  CHECK(complaint<std::uint64_t>("correlator", "interval", 0, sample_state(5).time()) != "");
}

TEST_CASE("a plan that is not the configured one is refused before anything is allocated for it") {
  for (const double value : {std::nan(""), -1.0, 1e308}) {
    CAPTURE(value);
    CHECK(complaint("plan", "interval_length", value) != "");
    CHECK(complaint("plan", "lags_per_decade", value) != "");
  }
  CHECK(complaint("plan", "start", std::nan("")) != "");
  CHECK(complaint("plan", "shortest_lag", 1e-300) != "");
  CHECK(complaint("plan", "intervals", std::uint64_t{1} << 40) != "");
  CHECK(complaint("plan", "origins", std::uint64_t{1} << 40) != "");
  CHECK(complaint("plan", "temperature_samples", std::uint64_t{1} << 40) != "");
  CHECK(complaint("plan", "wavenumbers", std::vector<double>(1000, 1.0)) != "");
}
