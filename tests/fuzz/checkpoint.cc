// A checkpoint, restored into the observers of a run as --resume does it. The seal is made right for every input.
#include "sandglass/io/checkpoint.h"

#include "fuzz.h"
#include "hdf5_mutator.h"
#include "sandglass/io/config.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/seal.h"
#include "sandglass/study/measurement.h"

using namespace sandglass;

namespace {

constexpr double beat = 0.1;

Config small_config() {
  Config config;
  config.run.intervals = 2;
  config.observe.lags_per_decade = 2;
  return config;
}

}  // namespace

void write_seed(const std::filesystem::path& path) {
  const Config config = small_config();
  State state = sample_state(3);
  Measurement measurement(state, beat);
  measurement.begin(plan_measurement(state.time(), 10, config.run.intervals, beat, config.observe.lags_per_decade,
                                     config.observe.wavenumbers),
                    state.tally);
  std::uint64_t measuring = 1;
  std::vector<FieldGroup> stored = measurement.fields();
  stored.push_back(measurement.plan_fields());
  stored.push_back({"run", {{"measuring", &measuring}}});
  write_checkpoint(path, state, config_to_toml(config), stored);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  file.fill(data, size);
  if (size >= seal_size) seal_file(file.path());
  read_or_refuse([&] {
    std::uint64_t measuring = 0;
    const Checkpoint checkpoint = read_checkpoint(file.path(), {{"run", {{"measuring", &measuring}}}});
    Measurement measurement(checkpoint.state, beat);
    restore_fields(checkpoint, {measurement.plan_fields()});
    measurement.prepare_restore(measuring == 1, small_config());
    restore_fields(checkpoint, measurement.fields());
    measurement.finish_restore(checkpoint.state.time());
    (void)measurement.results();
    if (measurement.begun()) (void)measurement.correlator().next_sample();
  });
  return 0;
}
