// A checkpoint, restored into the observers of a run as --resume does it. The seal is made right for every input.
#include "sandglass/io/checkpoint.h"

#include "fuzz.h"
#include "hdf5_mutator.h"
#include "sandglass/io/config.h"
#include "sandglass/io/sample_state.h"
#include "sandglass/io/seal.h"
#include "sandglass/study/small_measurement.test.h"

using namespace sandglass;

void write_seed(const std::filesystem::path& path) {
  State state = sample_state(3);
  Measurement measurement(state, small_beat);
  measurement.begin(small_plan(state), state.tally);
  std::uint64_t measuring = 1;
  std::vector<FieldGroup> stored = measurement.fields();
  stored.push_back(measurement.plan_fields());
  stored.push_back({"run", {{"measuring", &measuring}}});
  write_checkpoint(path, state, config_to_toml(small_config()), stored);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static MemoryFile file;
  file.fill(data, size);
  if (size >= seal_size) seal_file(file.path());
  read_or_refuse([&] {
    std::uint64_t measuring = 0;
    const Checkpoint checkpoint = read_checkpoint(file.path(), {{"run", {{"measuring", &measuring}}}});
    Measurement measurement(checkpoint.state, small_beat);
    restore_fields(checkpoint, {measurement.plan_fields()});
    measurement.prepare_restore(measuring == 1, small_config());
    restore_fields(checkpoint, measurement.fields());
    measurement.finish_restore(checkpoint.state.time());
    (void)measurement.results();
    if (measurement.begun()) (void)measurement.correlator().next_sample();
  });
  return 0;
}
