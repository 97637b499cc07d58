#include "sandglass/study/run_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "sandglass/core/errors.h"
#include "sandglass/dynamics/epoch.h"
#include "sandglass/study/start.h"

namespace sandglass {
namespace {

void require(bool good, std::string_view what) {
  if (!good) throw InputError(fmt::format("the checkpoint is damaged: {}; start again with --force", what));
}

/// Times are sums and products of a few roundings.
bool same_time(double a, double b) { return std::fabs(a - b) <= 1e-9 * std::fmax(std::fabs(b), 1e-9); }

void check_state_of(const State& state, const Config& config, double beat) {
  const Counts counts = counts_of(config);
  const auto small_disks =
      std::count_if(state.disks.begin(), state.disks.end(), [](const Disk& disk) { return disk.species == small; });
  require(state.size() == config.system.particles && static_cast<std::size_t>(small_disks) == counts.small,
          "its disks are not those that are configured");
  require(state.mixture.radius[small] == 1 && state.mixture.radius[big] == config.system.size_ratio,
          "the sizes of its disks are not those that are configured");
  require(std::fabs(packing_fraction(state) - config.system.packing_fraction) <= 1e-9,
          "its packing fraction is not the one that is configured");
  require(state.seed == config.run.seed && state.collision.restitution == config.collision.restitution &&
              state.collision.collapse == config.collision.collapse_policy && state.drive.kind == config.drive.kind &&
              state.drive.partner == config.drive.partner,
          "its seed, collision law or drive is not the one that is configured");
  require(state.epoch_length == beats_per_epoch * beat, "its epochs are not those of the configured fluid");
}

}  // namespace

std::vector<Field> RunPlace::fields() {
  return {{"calibrating", &calibrating},
          {"beats", &beats},
          {"measuring", &measuring},
          {"first_beat", &first_beat},
          {"measured_beats", &measured_beats},
          {"early_beats", &marks.early_beats},
          {"late_beats", &marks.late_beats},
          {"early_collisions", &marks.early_collisions},
          {"late_collisions", &marks.late_collisions}};
}

void check_place(const RunPlace& place, const State& state, const Config& config, double beat) {
  check_state_of(state, config, beat);
  const bool calibrating = place.calibrating == 1, measuring = place.measuring == 1;
  require(place.calibrating <= 1 && place.measuring <= 1 && !(calibrating && measuring), "it is in no stage of a run");
  require(!calibrating || place.beats == 0, "it counts beats before the run has begun");
  require(calibrating || same_time(state.time(), static_cast<double>(place.beats) * beat),
          "its time is not that of its beats");
  if (measuring)
    require(place.first_beat <= place.beats && place.measured_beats >= 1 &&
                place.beats - place.first_beat <= place.measured_beats,
            "it is not within the stretch that is measured");
  else
    require(place.first_beat == 0 && place.measured_beats == 0, "it measures before the run is equilibrated");
  const RunPlace::Marks& marks = place.marks;
  require(std::has_single_bit(marks.late_beats) && marks.early_beats == marks.late_beats / 2 &&
              marks.late_beats <= std::max<std::uint64_t>(1, place.beats) && marks.early_collisions >= 0 &&
              marks.late_collisions >= marks.early_collisions && std::isfinite(marks.late_collisions),
          "its marks of collisions are out of order");
}

void check_place(const RunPlace& place, const MeasurementPlan& plan, double beat) {
  const auto time = [&](std::uint64_t beats) { return static_cast<double>(beats) * beat; };
  require(plan.start == time(place.first_beat) && same_time(plan.end(), time(place.first_beat + place.measured_beats)),
          "what it measures is not the stretch of its beats");
}

}  // namespace sandglass
