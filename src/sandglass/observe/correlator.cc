#include "sandglass/observe/correlator.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "sandglass/core/errors.h"
#include "sandglass/observe/msd.h"
#include "sandglass/observe/vacf.h"

namespace sandglass {

Correlator::Correlator(const MeasurementPlan& plan, const Population& population)
    : plan_(plan), population_(population), schedule_(make_schedule(plan)) {
  for (const double wavenumber : plan.wavenumbers) shells_.push_back(wave_shell(wavenumber, population.box_length));
  origins_.resize(schedule_.levels);
  for (Snapshot& origin : origins_) {
    for (auto* component : {&origin.x, &origin.y, &origin.vx, &origin.vy}) component->resize(population.size());
  }
  sums_.resize(plan.intervals * interval_size());
}

double Correlator::next_sample() const {
  if (interval_ >= plan_.intervals) return std::numeric_limits<double>::infinity();
  const double offset = schedule_.due[due_].offset;
  // The end of one interval is the start of the next, to the bit.
  if (offset >= plan_.interval_length) return plan_.interval_start(interval_ + 1);
  return plan_.interval_start(interval_) + offset;
}

void Correlator::sample(const Frame& frame) {
  const double now = next_sample();
  if (now == std::numeric_limits<double>::infinity()) return;
  assert(frame.size() == population_.size());
  assert(std::fabs(frame.time - now) <= 1e-9 * (1 + now));
  take_snapshot(frame, population_, now_);
  if (interval_ == 0 && due_ == 0) first_collisions_ = frame.collisions_per_disk;
  elapsed_time_ = now - plan_.start;
  elapsed_collisions_ = frame.collisions_per_disk - first_collisions_;
  while (next_sample() <= now) {
    const Due& due = schedule_.due[due_];
    if (due.kind == Due::Kind::evaluate) {
      evaluate(due.level, due.lag);
    } else {
      origins_[due.level] = now_;
      if (due.level == schedule_.levels - 1) evaluate(due.level, 0);
    }
    if (++due_ == schedule_.due.size()) {
      due_ = 0;
      ++interval_;
    }
  }
}

std::size_t Correlator::interval_size() const {
  return schedule_.lags.size() * (scattering + shells_.size()) * species_count;
}

std::size_t Correlator::slot(std::size_t interval, std::size_t lag, std::size_t quantity, Species species) const {
  return interval * interval_size() + (lag * (scattering + shells_.size()) + quantity) * species_count + species;
}

void Correlator::evaluate(std::size_t level, std::size_t lag) {
  const Snapshot& origin = origins_[level];
  const double scale = displacement_scale(schedule_.lags[lag]);
  for (const Species species : {small, big}) {
    const Range range = population_.range(species);
    auto sum = [&](std::size_t quantity) -> ExactSum& { return sums_[slot(interval_, lag, quantity, species)]; };
    add_displacements(origin, now_, range, scale, sum(square), sum(fourth));
    add_velocity_products(origin, now_, range, sum(velocity));
    for (std::size_t k = 0; k < shells_.size(); ++k)
      add_scattering(origin, now_, range, shells_[k], population_.box_length, sum(scattering + k));
  }
}

void Correlator::merge(const Correlator& other) {
  if (!compatible(plan_, other.plan_) || population_.order != other.population_.order)
    throw RunError(
        "Two runs measured by different plans or with different disks cannot be merged; merge runs of one "
        "configuration that differ in their seed alone.");
  auto append = [&](std::size_t first, std::size_t last) {
    const auto size = static_cast<std::ptrdiff_t>(other.interval_size());
    sums_.insert(sums_.end(), other.sums_.begin() + static_cast<std::ptrdiff_t>(first) * size,
                 other.sums_.begin() + static_cast<std::ptrdiff_t>(last) * size);
  };
  const std::size_t held = other.sums_.size() / other.interval_size();
  append(0, other.interval_);
  append(other.plan_.intervals, held);
  merged_time_ += other.elapsed_time_ + other.merged_time_;
  merged_collisions_ += other.elapsed_collisions_ + other.merged_collisions_;
}

std::vector<Field> Correlator::fields() {
  std::vector<Field> list{{"interval", &interval_},
                          {"due", &due_},
                          {"sums", &sums_},
                          {"first_collisions", &first_collisions_},
                          {"elapsed_time", &elapsed_time_},
                          {"elapsed_collisions", &elapsed_collisions_},
                          {"merged_time", &merged_time_},
                          {"merged_collisions", &merged_collisions_}};
  for (std::size_t level = 0; level < origins_.size(); ++level) {
    const std::string name = "origin" + std::to_string(level) + "/";
    Snapshot& origin = origins_[level];
    list.push_back({name + "x", &origin.x});
    list.push_back({name + "y", &origin.y});
    list.push_back({name + "vx", &origin.vx});
    list.push_back({name + "vy", &origin.vy});
  }
  return list;
}

bool Correlator::valid() const {
  return interval_ < plan_.intervals ? due_ < schedule_.due.size() : interval_ == plan_.intervals && due_ == 0;
}

double Correlator::collision_rate() const {
  return (elapsed_collisions_ + merged_collisions_) / (elapsed_time_ + merged_time_);
}

IntervalSeries Correlator::series(std::size_t quantity, Group group) const {
  IntervalSeries series;
  series.time = schedule_.lags;
  const std::size_t lags = schedule_.lags.size(), held = sums_.size() / interval_size();
  series.totals.resize(lags);
  const double disks = static_cast<double>(population_.range(group).size());
  for (std::size_t interval = 0; interval < held; ++interval) {
    if (interval >= interval_ && interval < plan_.intervals) continue;  // not finished
    ++series.intervals;
    for (std::size_t lag = 0; lag < lags; ++lag) {
      ExactSum sum;
      if (group != Group::big) sum.add(sums_[slot(interval, lag, quantity, small)]);
      if (group != Group::small) sum.add(sums_[slot(interval, lag, quantity, big)]);
      const double scale = displacement_scale(schedule_.lags[lag]), scale2 = scale * scale;
      const double unit = quantity == square ? scale2 : quantity == fourth ? scale2 * scale2 : 1.0;
      const auto evaluations = static_cast<double>(schedule_.origins(schedule_.level_of_lag[lag], plan_));
      const double mean = sum.value() / unit / (evaluations * disks);
      series.means.push_back(mean);
      series.totals[lag] += mean;
    }
  }
  return series;
}

IntervalSeries Correlator::mean_square_displacement(Group group) const { return series(square, group); }
IntervalSeries Correlator::mean_fourth_displacement(Group group) const { return series(fourth, group); }
IntervalSeries Correlator::velocity_autocorrelation(Group group) const { return series(velocity, group); }
IntervalSeries Correlator::self_intermediate_scattering(Group group, std::size_t wavenumber) const {
  return series(scattering + wavenumber, group);
}

}  // namespace sandglass
