#include "sandglass/observe/thermodynamics.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/observe/portable.h"

namespace sandglass {

namespace {

std::vector<double> log_spaced(double first_time, std::uint64_t per_decade) {
  constexpr std::uint64_t decades = 16;
  const double step = std::numbers::ln10 / static_cast<double>(per_decade);
  std::vector<double> times{0.0};
  for (std::uint64_t j = 0; j <= decades * per_decade; ++j)
    times.push_back(first_time * portable_exp(static_cast<double>(j) * step));
  return times;
}

}  // namespace

Timeseries::Timeseries(const Population& population, double first_time, std::uint64_t per_decade)
    : Timeseries(population, log_spaced(first_time, per_decade)) {}

Timeseries::Timeseries(const Population& population, std::vector<double> times)
    : population_(population), times_(std::move(times)) {
  for (auto* values : {&collisions_, &all_, &small_, &big_}) values->resize(times_.size());
}

double Timeseries::next_sample() const {
  return next_ < times_.size() ? times_[next_] : std::numeric_limits<double>::infinity();
}

void Timeseries::sample(const Frame& frame) {
  if (next_ == times_.size()) return;
  take_velocities(frame, population_, now_);
  const Temperatures t = temperatures(now_, population_);
  collisions_[next_] = frame.collisions_per_disk;
  all_[next_] = t.all;
  small_[next_] = t.small;
  big_[next_] = t.big;
  ++next_;
}

void Timeseries::merge(const Timeseries& other) {
  if (times_ != other.times_ || next_ != other.next_)
    throw RunError(
        "Two time series that were not sampled at the same times cannot be averaged; merge runs of one "
        "configuration and length that differ in their seed alone.");
  auto add = [](std::vector<double>& mine, const std::vector<double>& theirs) {
    for (std::size_t i = 0; i < mine.size(); ++i) mine[i] += theirs[i];
  };
  add(collisions_, other.collisions_);
  add(all_, other.all_);
  add(small_, other.small_);
  add(big_, other.big_);
  runs_ += other.runs_;
}

std::vector<Field> Timeseries::fields() {
  return {{"next", &next_}, {"runs", &runs_},   {"collisions", &collisions_},
          {"all", &all_},   {"small", &small_}, {"big", &big_}};
}

bool Timeseries::valid() const { return next_ <= times_.size() && runs_ >= 1; }

std::vector<Dataset> Timeseries::results() const {
  std::vector<Dataset> results;
  auto add = [&](const char* name, const std::vector<double>& sums, double runs, const char* unit) {
    std::vector<double> values(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(next_));
    for (double& value : values) value /= runs;
    results.push_back({std::string("/timeseries/") + name, {values.size()}, std::move(values), unit});
  };
  const auto runs = static_cast<double>(runs_);
  add("time", times_, 1, "t");
  add("collisions", collisions_, runs, "");
  add("temperature_all", all_, runs, "m_s R_s^2/t^2");
  add("temperature_small", small_, runs, "m_s R_s^2/t^2");
  add("temperature_big", big_, runs, "m_s R_s^2/t^2");
  return results;
}

IntervalAverages::IntervalAverages(const MeasurementPlan& plan, const Population& population)
    : plan_(plan), population_(population) {
  constexpr std::uint64_t wanted = 10;
  parts_ = std::min((wanted + plan.intervals - 1) / plan.intervals, plan.temperature_samples);
  sums_.resize(plan.intervals * parts_ * groups.size());
  boundaries_.resize(plan.intervals * (parts_ + 1));
}

double IntervalAverages::next_sample() const {
  if (interval_ == plan_.intervals && taken_ > 0) return std::numeric_limits<double>::infinity();
  const double start = plan_.interval_start(interval_);
  if (taken_ == 0) return start;
  return start + static_cast<double>(taken_) * plan_.interval_length / static_cast<double>(plan_.temperature_samples);
}

void IntervalAverages::sample(const Frame& frame) {
  if (next_sample() == std::numeric_limits<double>::infinity()) return;
  if (taken_ == 0 && interval_ > 0) boundaries_[interval_ * (parts_ + 1) - 1] = frame.collisions_per_disk;
  if (interval_ == plan_.intervals) {
    taken_ = 1;
    return;
  }
  const std::uint64_t part = taken_ * parts_ / plan_.temperature_samples;
  if (taken_ == first_sample(part)) boundaries_[interval_ * (parts_ + 1) + part] = frame.collisions_per_disk;
  take_velocities(frame, population_, now_);
  const Temperatures t = temperatures(now_, population_);
  ExactSum* sums = &sums_[(interval_ * parts_ + part) * groups.size()];
  sums[static_cast<std::size_t>(Group::all)].add(t.all);
  sums[static_cast<std::size_t>(Group::small)].add(t.small);
  sums[static_cast<std::size_t>(Group::big)].add(t.big);
  if (++taken_ == plan_.temperature_samples) {
    taken_ = 0;
    ++interval_;
  }
}

// An interval is finished when its end has been seen. Those of merged runs stand behind the run's own.
std::vector<std::size_t> IntervalAverages::finished() const {
  std::vector<std::size_t> list;
  const std::size_t own = taken_ > 0 || interval_ == 0 ? interval_ : interval_ - 1;
  for (std::size_t i = 0; i < boundaries_.size() / (parts_ + 1); ++i) {
    if (i < own || i >= plan_.intervals) list.push_back(i);
  }
  return list;
}

void IntervalAverages::merge(const IntervalAverages& other) {
  if (!compatible(plan_, other.plan_) || population_.order != other.population_.order)
    throw RunError(
        "Two runs measured by different plans or with different disks cannot be merged; merge runs of one "
        "configuration that differ in their seed alone.");
  for (const std::size_t i : other.finished()) {
    for (std::size_t part = 0; part < parts_; ++part)
      for (const Group group : groups) sums_.push_back(other.sum(i, part, group));
    for (std::size_t part = 0; part <= parts_; ++part) boundaries_.push_back(other.collisions(i, part));
  }
}

std::vector<Field> IntervalAverages::fields() {
  return {{"interval", &interval_}, {"taken", &taken_}, {"sums", &sums_}, {"boundaries", &boundaries_}};
}

bool IntervalAverages::valid() const {
  return interval_ < plan_.intervals ? taken_ < plan_.temperature_samples : interval_ == plan_.intervals && taken_ <= 1;
}

std::vector<double> IntervalAverages::interval_temperatures(Group group) const {
  std::vector<double> values;
  for (const std::size_t i : finished()) {
    ExactSum total;
    for (std::size_t part = 0; part < parts_; ++part) total.add(sum(i, part, group));
    values.push_back(total.value() / static_cast<double>(plan_.temperature_samples));
  }
  return values;
}

std::vector<double> IntervalAverages::interval_collision_rates() const {
  std::vector<double> values;
  for (const std::size_t i : finished())
    values.push_back((collisions(i, parts_) - collisions(i, 0)) / plan_.interval_length);
  return values;
}

std::vector<double> IntervalAverages::part_temperatures() const {
  std::vector<double> values;
  for (const std::size_t i : finished())
    for (std::size_t part = 0; part < parts_; ++part)
      values.push_back(sum(i, part, Group::all).value() /
                       static_cast<double>(first_sample(part + 1) - first_sample(part)));
  return values;
}

std::vector<double> IntervalAverages::part_collision_rates() const {
  const double step = plan_.interval_length / static_cast<double>(plan_.temperature_samples);
  std::vector<double> values;
  for (const std::size_t i : finished())
    for (std::size_t part = 0; part < parts_; ++part)
      values.push_back((collisions(i, part + 1) - collisions(i, part)) /
                       (static_cast<double>(first_sample(part + 1) - first_sample(part)) * step));
  return values;
}

std::vector<Dataset> IntervalAverages::results() const {
  std::vector<Dataset> results;
  auto add = [&](const std::string& name, std::vector<double> values, const char* unit) {
    results.push_back({"/timeseries/intervals/" + name, {values.size()}, std::move(values), unit});
  };
  std::vector<double> middles;
  for (const std::size_t i : finished())
    middles.push_back(plan_.interval_start(i % plan_.intervals) + plan_.interval_length / 2);
  add("time", std::move(middles), "t");
  for (const Group group : groups)
    add("temperature_" + group_name(group), interval_temperatures(group), "m_s R_s^2/t^2");
  add("collision_rate", interval_collision_rates(), "1/t");
  return results;
}

}  // namespace sandglass
