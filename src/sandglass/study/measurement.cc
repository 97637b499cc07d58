#include "sandglass/study/measurement.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

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
  const Config::Observe& observe = config.observe;
  const auto most_frames = static_cast<std::uint64_t>(observe.structure_frames.value_or(20));
  const bool configured = plan.intervals == config.run.intervals && plan.wavenumbers == observe.wavenumbers &&
                          plan.lags_per_decade == observe.lags_per_decade &&
                          plan.overlap_length == observe.overlap_length &&
                          plan.selection_time == observe.selection_time && plan.bin_width == observe.bin_width &&
                          plan.structure_frames <= most_frames;
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
  structure_.emplace(plan_, population_);
}

TallyAverages Measurement::tally_averages() const {
  const std::vector<double> temperatures = averages_->interval_temperatures(Group::all);
  return sandglass::tally_averages(boundaries_, plan_.interval_length, temperatures, disk_counts(population_));
}

std::vector<Dataset> Measurement::results() const {
  std::vector<Dataset> datasets = timeseries_.results();
  if (!begun()) return datasets;
  for (const auto& more : {correlator_->results(), averages_->results(), structure_->results()})
    datasets.insert(datasets.end(), more.begin(), more.end());
  append_flows(datasets);
  return datasets;
}

void Measurement::append_flows(std::vector<Dataset>& datasets) const {
  IntervalFlows flows = interval_flows(boundaries_, plan_.interval_length, averages_->interval_temperatures(Group::all),
                                       population_.size());
  const auto add = [&](const char* name, std::vector<double>& values, const char* unit) {
    datasets.push_back({std::string("/timeseries/intervals/") + name, {values.size()}, std::move(values), unit});
  };
  add("compressibility_factor", flows.compressibility_factor, "");
  add("injected", flows.injected, "m_s R_s^2/t^3");
  add("dissipated", flows.dissipated, "m_s R_s^2/t^3");
}

std::vector<FieldGroup> Measurement::fields() {
  store_boundaries();
  std::vector<FieldGroup> stored{{"timeseries", timeseries_.fields()}};
  stored.push_back({"tallies", {{"counts", &stored_counts_}, {"sums", &stored_sums_}}});
  if (begun()) {
    stored.push_back({"correlator", correlator_->fields()});
    stored.push_back({"averages", averages_->fields()});
    stored.push_back({"structure", structure_->fields()});
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

double Measurement::next_sample() const {
  double next = timeseries_.next_sample();
  if (begun()) next = std::min({next, correlator_->next_sample(), averages_->next_sample(), structure_->next_sample()});
  return next;
}

void Measurement::finish_restore(double now) {
  const bool placed =
      timeseries_.valid() && (!begun() || (correlator_->valid() && averages_->valid() && structure_->valid()));
  if (!placed || !(next_sample() >= now * (1 - 1e-9)))  // what is past was sampled, but for the rounding of its time
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
