// Temperatures and collisions against time, from the start of the run and by interval.
#pragma once

#include <vector>

#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/schedule.h"

namespace sandglass {

/// An Observer that records T_all, T_small, T_big and s at t = 0 and then at log-spaced times, without an end:
/// t_j = first * 10^(j / per_decade). 16 decades at most, so its memory is fixed.
class Timeseries {
 public:
  explicit Timeseries(const Population& population, double first_time, std::uint64_t per_decade = 20);
  /// The same at these times.
  Timeseries(const Population& population, std::vector<double> times);

  [[nodiscard]] double next_sample() const;
  void sample(const Frame& frame);
  /// Averages with an independent run that was sampled at the same times.
  void merge(const Timeseries& other);
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const;  ///< whether the place in time can be (after fields() were restored)
  /// /timeseries/{time, collisions, temperature_all, temperature_small, temperature_big}
  [[nodiscard]] std::vector<Dataset> results() const;

 private:
  Population population_;
  Snapshot now_;
  std::vector<double> times_;
  std::uint64_t next_ = 0, runs_ = 1;
  std::vector<double> collisions_, all_, small_, big_;  ///< sums over merged runs
};
static_assert(Observer<Timeseries>);

/// An Observer of the measured stretch: temperatures averaged over each interval (plan.temperature_samples evenly
/// spaced frames, the first at its start) and the collision rate of each interval, from s at its ends. Few intervals
/// are kept in several parts each, at least ten in all where there are as many samples, to see a trend by.
class IntervalAverages {
 public:
  IntervalAverages(const MeasurementPlan& plan, const Population& population);

  [[nodiscard]] double next_sample() const;
  void sample(const Frame& frame);
  /// Appends the intervals of an independent run with the same plan.
  void merge(const IntervalAverages& other);
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const;  ///< whether the place in the plan can be (after fields() were restored)
  /// /timeseries/intervals/{time (middle), temperature_all, temperature_small, temperature_big, collision_rate}
  [[nodiscard]] std::vector<Dataset> results() const;

  /// Mean over the finished intervals, with the standard error over them.
  [[nodiscard]] Estimate temperature(Group group) const { return mean_of_intervals(interval_temperatures(group)); }
  [[nodiscard]] Estimate collision_rate() const { return mean_of_intervals(interval_collision_rates()); }
  /// One value per finished interval.
  [[nodiscard]] std::vector<double> interval_temperatures(Group group) const;
  [[nodiscard]] std::vector<double> interval_collision_rates() const;
  /// One value per part of the finished intervals.
  [[nodiscard]] std::vector<double> part_temperatures() const;  ///< of all disks
  [[nodiscard]] std::vector<double> part_collision_rates() const;

 private:
  [[nodiscard]] std::vector<std::size_t> finished() const;
  /// The first sample of a part of any interval; that of part `parts_` is the first of the next interval.
  [[nodiscard]] std::uint64_t first_sample(std::uint64_t part) const {
    return (part * plan_.temperature_samples + parts_ - 1) / parts_;
  }
  [[nodiscard]] const ExactSum& sum(std::size_t interval, std::size_t part, Group group) const {
    return sums_[(interval * parts_ + part) * groups.size() + static_cast<std::size_t>(group)];
  }
  [[nodiscard]] double collisions(std::size_t interval, std::size_t part) const {
    return boundaries_[interval * (parts_ + 1) + part];
  }

  MeasurementPlan plan_;
  Population population_;
  Snapshot now_;
  std::uint64_t interval_ = 0, taken_ = 0;  ///< the next sample; interval_ == intervals: only the end is missing
  std::uint64_t parts_ = 1;                 ///< of an interval
  std::vector<ExactSum> sums_;              ///< of temperatures: [interval, part, group]
  std::vector<double> boundaries_;          ///< s where parts begin, and at the end: [interval, part + 1]
};
static_assert(Observer<IntervalAverages>);

}  // namespace sandglass
