#include "sandglass/study/measurement.h"

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

void Measurement::prepare_restore(bool begun) {
  if (begun) begin(plan_, {});
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
  if (stored_counts_.size() * sum_columns != stored_sums_.size() * count_columns)
    throw InputError("the checkpoint is damaged: its tallies do not fit each other");
  boundaries_.assign(stored_counts_.size() / count_columns, {});
  auto count = stored_counts_.begin();
  auto sum = stored_sums_.begin();
  for (Tally& tally : boundaries_) {
    visit_counts(tally, [&](std::uint64_t& target) { target = *count++; });
    visit_sums(tally, [&](ExactSum& target) { target = *sum++; });
  }
}

}  // namespace sandglass
