// Time correlations on line: MSD, VACF, S_inc and what else two moments tell, by lag, species and interval, in constant
// memory.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sandglass/observe/cage.h"
#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/mobility.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/scattering.h"
#include "sandglass/observe/schedule.h"

namespace sandglass {

/// An Observer that follows a Schedule: one origin frame per level is kept, every due (level, lag) is evaluated by the
/// free functions of msd.h, vacf.h, scattering.h and cage.h and added to exact sums by (interval, lag, species). What
/// needs the neighbours of the origin or the fate of single disks is evaluated for the first origin of each interval.
class Correlator {
 public:
  Correlator(const MeasurementPlan& plan, const Population& population);
  Correlator(const MeasurementPlan& plan, const Population& population, Schedule schedule);

  [[nodiscard]] double next_sample() const;
  void sample(const Frame& frame);
  /// Appends the finished intervals of an independent run with the same plan. Throws RunError for a different one.
  void merge(const Correlator& other);
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const;  ///< whether the place in the plan can be (after fields() were restored)
  /// /dynamics/{all,small,big}/{mean_square_displacement, velocity_autocorrelation, running_diffusion,
  /// self_intermediate_scattering, gaussian_approximation, non_gaussian, cage_relative_displacement, overlap,
  /// susceptibility, van_hove, mobility}: docs/file-formats.md. Over finished intervals: `error` is the standard error
  /// over them, NaN with fewer than two; `count` the number of displacements averaged. Groups without disks are left
  /// out.
  [[nodiscard]] std::vector<Dataset> results() const;

  /// The measured quantities by name, for fits and for ageing (each interval apart).
  [[nodiscard]] IntervalSeries mean_square_displacement(Group group) const;
  [[nodiscard]] IntervalSeries mean_fourth_displacement(Group group) const;
  [[nodiscard]] IntervalSeries velocity_autocorrelation(Group group) const;
  /// D(t) = <v(0) . dr(t)> / 2, half the integral of the velocity autocorrelation up to t.
  [[nodiscard]] IntervalSeries running_diffusion(Group group) const;
  [[nodiscard]] IntervalSeries self_intermediate_scattering(Group group, std::size_t wavenumber) const;
  [[nodiscard]] IntervalSeries cage_relative_displacement(Group group) const;
  [[nodiscard]] IntervalSeries overlap(Group group) const;          ///< Q: the part of the disks with |dr| <= a
  [[nodiscard]] IntervalSeries squared_overlap(Group group) const;  ///< <Q^2> over the pairs of moments
  [[nodiscard]] IntervalSeries mobility(Group group, Mobility::Tail tail) const;

  [[nodiscard]] const MeasurementPlan& plan() const { return plan_; }
  [[nodiscard]] const Schedule& schedule() const { return schedule_; }
  /// Collisions per disk and time over the sampled stretch.
  [[nodiscard]] double collision_rate() const;

 private:
  // Quantities stand in this order in `sums_`; wavenumber k is `scattering + k`. Of the overlap, `overlapping` counts
  // disks and `overlap_square` its square; the product of both species is `overlap_product`, with the small ones.
  enum Quantity : std::size_t {
    square = 0,
    fourth = 1,
    velocity = 2,
    velocity_displacement = 3,
    overlapping = 4,
    overlap_square = 5,
    overlap_product = 6,
    relative = 7,
    scattering = 8
  };
  [[nodiscard]] std::size_t slot(std::size_t interval, std::size_t lag, std::size_t quantity, Species species) const;
  [[nodiscard]] std::size_t interval_size() const;
  [[nodiscard]] std::size_t histogram_size() const;
  [[nodiscard]] std::uint64_t* histogram(std::size_t lag, Species species);
  void evaluate(std::size_t level, std::size_t lag);
  void evaluate_first(const Snapshot& origin, std::size_t lag);
  [[nodiscard]] std::vector<std::size_t> finished() const;
  /// `mean(interval, lag)` for every finished interval.
  [[nodiscard]] IntervalSeries series(const std::function<double(std::size_t, std::size_t)>& mean) const;
  [[nodiscard]] double sum(std::size_t interval, std::size_t lag, std::size_t quantity, Group group) const;
  [[nodiscard]] std::uint64_t counted(std::size_t interval, std::size_t histogram, std::size_t bin, Group group) const;
  [[nodiscard]] IntervalSeries per_disk(std::size_t quantity, Group group) const;

  class Results;  // correlator_results.cc

  MeasurementPlan plan_;
  Population population_;
  Schedule schedule_;
  std::vector<WaveShell> shells_;
  Snapshot now_;

  std::uint64_t interval_ = 0, due_ = 0;     ///< the next entry of the schedule
  std::vector<Snapshot> origins_;            ///< by level
  std::vector<ExactSum> sums_;               ///< [interval, lag, quantity, species]
  std::vector<std::size_t> histogram_lags_;  ///< lags of the van Hove function
  std::vector<std::uint64_t> histograms_;    ///< [interval, lag, species, bin and beyond]
  Mobility mobility_;
  Cages cages_;  ///< at the start of the interval `caged_interval_`; made anew on resuming
  std::uint64_t caged_interval_ = no_interval;
  double first_collisions_ = 0;
  double elapsed_time_ = 0, elapsed_collisions_ = 0;  ///< of this run
  double merged_time_ = 0, merged_collisions_ = 0;    ///< of the runs merged in
};

static_assert(Observer<Correlator>);

}  // namespace sandglass
