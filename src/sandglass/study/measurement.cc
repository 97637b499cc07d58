#include "sandglass/study/measurement.h"

#include <cmath>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

// A tally as a row of counts and a row of sums, the same way in and out.
constexpr std::size_t count_columns = 9, sum_columns = 3;
template <class T, class Visit>
void visit_counts(T& tally, Visit&& visit) {
  for (auto& count : tally.contacts) visit(count);
  for (auto& count : tally.kicked) visit(count);
  for (auto* count : {&tally.elastic_contacts, &tally.kicks, &tally.kicks_without_partner, &tally.transits})
    visit(*count);
}
template <class T, class Visit>
void visit_sums(T& tally, Visit&& visit) {
  for (auto* sum : {&tally.virial, &tally.dissipated, &tally.injected}) visit(*sum);
}

std::array<std::size_t, species_count> disk_counts(const Population& population) {
  return {population.range(small).size(), population.range(big).size()};
}

/// Nothing is allocated on the word of a checkpoint: what sets the size of the observers is in the configuration too.
void check_plan(const MeasurementPlan& plan, const Config& config) {
  constexpr double widest = 1e15;  // longest by shortest lag; 10^12 collisions per disk span less
  const bool configured = plan.intervals == config.run.intervals && plan.wavenumbers == config.observe.wavenumbers &&
                          plan.lags_per_decade == config.observe.lags_per_decade;
  if (!configured || !std::isfinite(plan.start) || plan.start < 0 || !std::isfinite(plan.end()) ||
      !(plan.interval_length <= widest * plan.shortest_lag) || plan.temperature_samples > 10000)
    throw InputError("the checkpoint is damaged: what it measures is not what is configured");
}

}  // namespace

Measurement::Measurement(const State& start, double beat)
    : population_(population_of(start)), timeseries_(population_, beat / 100) {}

void Measurement::begin(const MeasurementPlan& plan, const Tally& boundary) {
  plan_ = plan;
  boundaries_ = {boundary};
  correlator_.emplace(plan_, population_);
  averages_.emplace(plan_, population_);
}

TallyAverages Measurement::tally_averages() const {
  const std::vector<double> temperatures = averages_->interval_temperatures(Group::all);
  return sandglass::tally_averages(boundaries_, plan_.interval_length, temperatures, disk_counts(population_));
}

std::vector<Dataset> Measurement::results() const {
  std::vector<Dataset> datasets = timeseries_.results();
  if (!begun()) return datasets;
  for (const auto& more : {correlator_->results(), averages_->results()})
    datasets.insert(datasets.end(), more.begin(), more.end());
  return datasets;
}

std::vector<FieldGroup> Measurement::fields() {
  store_boundaries();
  std::vector<FieldGroup> stored{{"timeseries", timeseries_.fields()}};
  stored.push_back({"tallies", {{"counts", &stored_counts_}, {"sums", &stored_sums_}}});
  if (begun()) {
    stored.push_back({"correlator", correlator_->fields()});
    stored.push_back({"averages", averages_->fields()});
  }
  return stored;
}

FieldGroup Measurement::plan_fields() { return {"plan", plan_.fields()}; }

void Measurement::prepare_restore(bool begun, const Config& config) {
  if (begun) {
    check_plan(plan_, config);
    begin(plan_, {});
  }
  boundaries_.clear();
}

void Measurement::store_boundaries() {
  stored_counts_.clear();
  stored_sums_.clear();
  for (const Tally& tally : boundaries_) {
    visit_counts(tally, [&](const std::uint64_t& count) { stored_counts_.push_back(count); });
    visit_sums(tally, [&](const ExactSum& sum) { stored_sums_.push_back(sum); });
  }
}

void Measurement::finish_restore() {
  if (!timeseries_.valid() || (begun() && !(correlator_->valid() && averages_->valid())))
    throw InputError("the checkpoint is damaged: it stands at no time of its measurement");
  if (stored_counts_.size() % count_columns != 0 || stored_sums_.size() % sum_columns != 0 ||
      stored_counts_.size() / count_columns != stored_sums_.size() / sum_columns)
    throw InputError("the checkpoint is damaged: its tallies do not fit each other");
  const std::size_t held = stored_counts_.size() / count_columns;
  if (begun() ? held < 1 || held > plan_.intervals + 1 : held != 0)
    throw InputError("the checkpoint is damaged: it holds a wrong number of tallies");
  boundaries_.assign(held, {});
  auto count = stored_counts_.begin();
  auto sum = stored_sums_.begin();
  for (Tally& tally : boundaries_) {
    visit_counts(tally, [&](std::uint64_t& target) { target = *count++; });
    visit_sums(tally, [&](ExactSum& target) { target = *sum++; });
  }
}

}  // namespace sandglass
