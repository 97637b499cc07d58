// Time correlations on line: MSD, VACF, S_inc, alpha_2 by lag, species and interval, in constant memory.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/scattering.h"
#include "sandglass/observe/schedule.h"

namespace sandglass {

/// An Observer that follows a Schedule: one origin frame per level is kept, every due (level, lag) is evaluated by the
/// free functions of msd.h, vacf.h and scattering.h and added to exact sums by (interval, lag, species).
class Correlator {
 public:
  Correlator(const MeasurementPlan& plan, const Population& population);

  [[nodiscard]] double next_sample() const;
  void sample(const Frame& frame);
  /// Appends the finished intervals of an independent run with the same plan. Throws RunError for a different one.
  void merge(const Correlator& other);
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const;  ///< whether the place in the plan can be (after fields() were restored)
  /// /dynamics/{all,small,big}/{mean_square_displacement, velocity_autocorrelation, self_intermediate_scattering,
  /// gaussian_approximation, non_gaussian}/{time, collisions, value, error, count}, for the scattering also wavenumber
  /// and value[k, lag]; velocity_autocorrelation has equal_time_value and equal_time_error, <v^2>. Over
  /// finished intervals: `error` is the standard error over them, NaN with fewer than two; `count` the number of
  /// displacements averaged. Groups without disks are left out.
  [[nodiscard]] std::vector<Dataset> results() const;

  /// The measured quantities by name, for fits and for ageing (each interval apart).
  [[nodiscard]] IntervalSeries mean_square_displacement(Group group) const;
  [[nodiscard]] IntervalSeries mean_fourth_displacement(Group group) const;
  [[nodiscard]] IntervalSeries velocity_autocorrelation(Group group) const;
  [[nodiscard]] IntervalSeries self_intermediate_scattering(Group group, std::size_t wavenumber) const;

  [[nodiscard]] const MeasurementPlan& plan() const { return plan_; }
  [[nodiscard]] const Schedule& schedule() const { return schedule_; }
  /// Collisions per disk and time over the sampled stretch.
  [[nodiscard]] double collision_rate() const;

 private:
  // Quantities stand in this order in `sums_`; wavenumber k is `scattering + k`.
  enum Quantity : std::size_t { square = 0, fourth = 1, velocity = 2, scattering = 3 };
  [[nodiscard]] std::size_t slot(std::size_t interval, std::size_t lag, std::size_t quantity, Species species) const;
  [[nodiscard]] std::size_t interval_size() const;
  void evaluate(std::size_t level, std::size_t lag);
  [[nodiscard]] IntervalSeries series(std::size_t quantity, Group group) const;
  void append_results(std::vector<Dataset>& results, Group group) const;

  MeasurementPlan plan_;
  Population population_;
  Schedule schedule_;
  std::vector<WaveShell> shells_;
  Snapshot now_;

  std::uint64_t interval_ = 0, due_ = 0;  ///< the next entry of the schedule
  std::vector<Snapshot> origins_;         ///< by level
  std::vector<ExactSum> sums_;            ///< [interval, lag, quantity, species]
  double first_collisions_ = 0;
  double elapsed_time_ = 0, elapsed_collisions_ = 0;  ///< of this run
  double merged_time_ = 0, merged_collisions_ = 0;    ///< of the runs merged in
};

static_assert(Observer<Correlator>);

}  // namespace sandglass
