#include "sandglass/observe/correlator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "sandglass/core/errors.h"
#include "sandglass/observe/msd.h"
#include "sandglass/observe/vacf.h"
#include "sandglass/observe/van_hove.h"

namespace sandglass {

Correlator::Correlator(const MeasurementPlan& plan, const Population& population)
    : Correlator(plan, population, make_schedule(plan)) {}

Correlator::Correlator(const MeasurementPlan& plan, const Population& population, Schedule schedule)
    : plan_(plan),
      population_(population),
      schedule_(std::move(schedule)),
      histogram_lags_(schedule_.one_lag_per_decade()),
      mobility_(schedule_.lags,
                schedule_.nearest_lag(plan.selection_time > 0 ? plan.selection_time : plan.interval_length), population,
                plan.intervals) {
  for (const double wavenumber : plan.wavenumbers) shells_.push_back(wave_shell(wavenumber, population.box_length));
  origins_.resize(schedule_.levels);
  for (Snapshot& origin : origins_) {
    for (auto* component : {&origin.x, &origin.y, &origin.vx, &origin.vy}) component->resize(population.size());
  }
  sums_.resize(plan.intervals * interval_size());
  histograms_.resize(plan.intervals * histogram_size());
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
      if (due.kind == Due::Kind::new_compared_origin) evaluate(due.level, 0);
    }
    if (++due_ == schedule_.due.size()) {
      mobility_.finish(interval_);
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

std::size_t Correlator::histogram_size() const { return histogram_lags_.size() * species_count * (van_hove_bins + 1); }

std::uint64_t* Correlator::histogram(std::size_t lag, Species species) {
  for (std::size_t i = 0; i < histogram_lags_.size(); ++i)
    if (histogram_lags_[i] == lag)
      return &histograms_[interval_ * histogram_size() + (i * species_count + species) * (van_hove_bins + 1)];
  return nullptr;
}

void Correlator::evaluate(std::size_t level, std::size_t lag) {
  const Snapshot& origin = origins_[level];
  const double scale = displacement_scale(schedule_.lags[lag]);
  auto sum = [&](std::size_t quantity, Species species) -> ExactSum& {
    return sums_[slot(interval_, lag, quantity, species)];
  };
  std::array<double, species_count> overlaps{};
  for (const Species species : {small, big}) {
    const Range range = population_.range(species);
    DisplacementSums displacements;
    displacements.by_distance = histogram(lag, species);
    // Block by block, as the sums are made anyway, so that what is read several times is still in the nearest cache.
    for (Range block{range.begin, range.begin}; block.begin < range.end; block.begin = block.end) {
      block.end = std::min(block.begin + block_size, range.end);
      add_displacements(origin, now_, block, scale, plan_.overlap_length, displacements);
      add_velocity_products(origin, now_, block, sum(velocity, species));
      add_velocity_displacements(origin, now_, block, scale, sum(velocity_displacement, species));
      for (std::size_t k = 0; k < shells_.size(); ++k)
        add_scattering(origin, now_, block, shells_[k], population_.box_length, sum(scattering + k, species));
    }
    sum(square, species).add(displacements.square);
    sum(fourth, species).add(displacements.fourth);
    overlaps[species] = static_cast<double>(displacements.overlapping);
    sum(overlapping, species).add(overlaps[species]);
    sum(overlap_square, species).add(overlaps[species] * overlaps[species]);
  }
  sum(overlap_product, small).add(overlaps[small] * overlaps[big]);
  if (lag > 0 && schedule_.due[due_].offset == schedule_.lags[lag]) evaluate_first(origin, lag);
}

// The first origin of every level is that of level 0, the start of the interval, which is kept to its end: the cages
// can be found anew from it at any time.
void Correlator::evaluate_first(const Snapshot& origin, std::size_t lag) {
  if (caged_interval_ != interval_) {
    cages_ = cages_of(origins_[0], population_);
    caged_interval_ = interval_;
  }
  const RelativeDisplacements displacements = relative_displacements(origin, now_, cages_);
  for (const Species species : {small, big})
    add_squares(displacements, population_.range(species), displacement_scale(schedule_.lags[lag]),
                sums_[slot(interval_, lag, relative, species)]);
  mobility_.add(lag, origin, now_);
}

void Correlator::merge(const Correlator& other) {
  if (!compatible(plan_, other.plan_) || population_.order != other.population_.order)
    throw RunError(
        "Two runs measured by different plans or with different disks cannot be merged; merge runs of one "
        "configuration that differ in their seed alone.");
  const auto append_part = [](auto& mine, const auto& theirs, std::size_t first, std::size_t last, std::size_t size) {
    mine.insert(mine.end(), theirs.begin() + static_cast<std::ptrdiff_t>(first * size),
                theirs.begin() + static_cast<std::ptrdiff_t>(last * size));
  };
  const auto append = [&](std::size_t first, std::size_t last) {
    append_part(sums_, other.sums_, first, last, interval_size());
    append_part(histograms_, other.histograms_, first, last, histogram_size());
    mobility_.append(other.mobility_, first, last - first);
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
                          {"histograms", &histograms_},
                          {"first_collisions", &first_collisions_},
                          {"elapsed_time", &elapsed_time_},
                          {"elapsed_collisions", &elapsed_collisions_},
                          {"merged_time", &merged_time_},
                          {"merged_collisions", &merged_collisions_}};
  for (Field& field : mobility_.fields()) list.push_back(std::move(field));
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

std::vector<std::size_t> Correlator::finished() const {
  std::vector<std::size_t> list;
  for (std::size_t interval = 0; interval < sums_.size() / interval_size(); ++interval)
    if (interval < interval_ || interval >= plan_.intervals) list.push_back(interval);
  return list;
}

IntervalSeries Correlator::series(const std::function<double(std::size_t, std::size_t)>& mean) const {
  IntervalSeries series;
  series.time = schedule_.lags;
  series.totals.resize(schedule_.lags.size());
  for (const std::size_t interval : finished()) {
    ++series.intervals;
    for (std::size_t lag = 0; lag < schedule_.lags.size(); ++lag) {
      series.means.push_back(mean(interval, lag));
      series.totals[lag] += series.means.back();
    }
  }
  return series;
}

/// Over the disks of the group and the pairs of moments, displacements unscaled.
double Correlator::sum(std::size_t interval, std::size_t lag, std::size_t quantity, Group group) const {
  ExactSum sum;
  if (group != Group::big) sum.add(sums_[slot(interval, lag, quantity, small)]);
  if (group != Group::small) sum.add(sums_[slot(interval, lag, quantity, big)]);
  const double scale = displacement_scale(schedule_.lags[lag]), scale2 = scale * scale;
  const bool squared = quantity == square || quantity == relative;
  const bool linear = quantity == velocity_displacement;
  return sum.value() / (squared ? scale2 : quantity == fourth ? scale2 * scale2 : linear ? scale : 1.0);
}

std::uint64_t Correlator::counted(std::size_t interval, std::size_t histogram, std::size_t bin, Group group) const {
  const std::uint64_t* bins =
      &histograms_[interval * histogram_size() + histogram * species_count * (van_hove_bins + 1)];
  return (group != Group::big ? bins[bin] : 0) + (group != Group::small ? bins[van_hove_bins + 1 + bin] : 0);
}

IntervalSeries Correlator::per_disk(std::size_t quantity, Group group) const {
  const auto disks = static_cast<double>(population_.range(group).size());
  return series([&](std::size_t interval, std::size_t lag) {
    const auto moments = quantity == relative ? 1.0 : static_cast<double>(schedule_.origins[lag]);
    return sum(interval, lag, quantity, group) / (moments * disks);
  });
}

IntervalSeries Correlator::mean_square_displacement(Group group) const { return per_disk(square, group); }
IntervalSeries Correlator::mean_fourth_displacement(Group group) const { return per_disk(fourth, group); }
IntervalSeries Correlator::velocity_autocorrelation(Group group) const { return per_disk(velocity, group); }
IntervalSeries Correlator::running_diffusion(Group group) const {
  IntervalSeries series = per_disk(velocity_displacement, group);
  for (auto* values : {&series.means, &series.totals})
    for (double& value : *values) value /= 2;
  return series;
}
IntervalSeries Correlator::cage_relative_displacement(Group group) const { return per_disk(relative, group); }
IntervalSeries Correlator::overlap(Group group) const { return per_disk(overlapping, group); }
IntervalSeries Correlator::self_intermediate_scattering(Group group, std::size_t wavenumber) const {
  return per_disk(scattering + wavenumber, group);
}

IntervalSeries Correlator::squared_overlap(Group group) const {
  const auto disks = static_cast<double>(population_.range(group).size());
  return series([&](std::size_t interval, std::size_t lag) {
    double squares = sum(interval, lag, overlap_square, group);
    if (group == Group::all) squares += 2 * sums_[slot(interval, lag, overlap_product, small)].value();
    return squares / (static_cast<double>(schedule_.origins[lag]) * disks * disks);
  });
}

IntervalSeries Correlator::mobility(Group group, Mobility::Tail tail) const {
  const auto chosen = static_cast<double>(mobility_.chosen(group));
  return series(
      [&](std::size_t interval, std::size_t lag) { return mobility_.sum(interval, lag, group, tail) / chosen; });
}

}  // namespace sandglass
