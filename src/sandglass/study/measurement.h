// Everything that is measured in a run, as one thing to sample, store and evaluate.
#pragma once

#include <optional>
#include <vector>

#include "sandglass/core/state.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/config.h"
#include "sandglass/observe/correlator.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/structure_sampler.h"
#include "sandglass/observe/tally_averages.h"
#include "sandglass/observe/thermodynamics.h"

namespace sandglass {

/// The observers of a run. The relaxation is recorded from t = 0; the rest starts when equilibration ends and the plan
/// of the measured stretch is known.
class Measurement {
 public:
  /// \param beat one mean free time by the formula; the relaxation is recorded from a hundredth of it
  Measurement(const State& start, double beat);

  /// Fixes the measured stretch. `boundary` is the tally at its start.
  void begin(const MeasurementPlan& plan, const Tally& boundary);
  [[nodiscard]] bool begun() const { return correlator_.has_value(); }
  [[nodiscard]] const MeasurementPlan& plan() const { return plan_; }

  /// Advances the engine to time `end`, showing every observer its frames, and `extra`, an observer of the caller's,
  /// and noting the tally at the end of each interval.
  template <class Engine, Observer Extra>
  void run_until(Engine& engine, double end, Extra& extra) {
    if (!begun()) {
      sandglass::run_until(engine, end, frame_, timeseries_, extra);
      return;
    }
    for (; boundaries_.size() <= plan_.intervals && plan_.interval_start(boundaries_.size()) <= end;
         boundaries_.push_back(engine.tally()))
      sandglass::run_until(engine, plan_.interval_start(boundaries_.size()), frame_, timeseries_, *correlator_,
                           *averages_, *structure_, extra);
    sandglass::run_until(engine, end, frame_, timeseries_, *correlator_, *averages_, *structure_, extra);
  }

  [[nodiscard]] const Correlator& correlator() const { return *correlator_; }
  [[nodiscard]] const IntervalAverages& averages() const { return *averages_; }
  [[nodiscard]] const StructureSampler& structure() const { return *structure_; }
  [[nodiscard]] const std::vector<Tally>& boundaries() const { return boundaries_; }
  [[nodiscard]] TallyAverages tally_averages() const;
  [[nodiscard]] std::vector<Dataset> results() const;

  // Checkpoints: what to store; and, in a measurement just made from the start, the two steps of restoring.
  [[nodiscard]] std::vector<FieldGroup> fields();
  [[nodiscard]] FieldGroup plan_fields();  ///< first: the plan, without which the observers have no size
  /// Then: makes the observers for it, to be filled through fields(). Throws InputError if it is not a plan of
  /// `config`.
  void prepare_restore(bool begun, const Config& config);
  /// Last: takes the tallies out of their stored form. Throws InputError if the observers stand where none can at time
  /// `now`.
  void finish_restore(double now);

 private:
  void append_flows(std::vector<Dataset>& datasets) const;
  void store_boundaries();
  [[nodiscard]] double next_sample() const;

  Population population_;
  MeasurementPlan plan_;
  Frame frame_;
  Timeseries timeseries_;
  std::optional<Correlator> correlator_;
  std::optional<IntervalAverages> averages_;
  std::optional<StructureSampler> structure_;
  std::vector<Tally> boundaries_;  ///< at the start of the measured stretch and the end of each interval
  std::vector<std::uint64_t> stored_counts_;
  std::vector<ExactSum> stored_sums_;
};

}  // namespace sandglass
