// When to sample: the measured stretch of a run, its intervals, lags and time origins.
#pragma once

#include <cstdint>
#include <vector>

#include "sandglass/core/fields.h"

namespace sandglass {

/// The measured stretch [start, start + intervals * interval_length] of a run and what is measured in it. Fixed at the
/// end of equilibration; kept in the checkpoint by fields().
struct MeasurementPlan {
  double start = 0;            ///< physical time since the start of the run
  double interval_length = 1;  ///< also the longest lag
  std::uint64_t intervals = 10;
  double shortest_lag = 0.01;
  double lags_per_decade = 12;
  std::uint64_t origins = 8;               ///< most time origins per level and interval, 1 ... 8
  std::uint64_t temperature_samples = 50;  ///< per interval, evenly spaced
  std::vector<double> wavenumbers{0.5, 3.0};
  double overlap_length = 0.6;          ///< a: how far a disk may have gone to count as overlapping with itself
  double selection_time = 0;            ///< lag at which the fastest and slowest disks are chosen; 0: the longest
  std::uint64_t structure_frames = 20;  ///< frames of which the static structure is taken
  double bin_width = 0;                 ///< of g(r); 0: L / 800, at most 0.4

  /// The time at which interval `index` starts, always by this expression.
  [[nodiscard]] double interval_start(std::uint64_t index) const {
    return start + static_cast<double>(index) * interval_length;
  }
  [[nodiscard]] double end() const { return interval_start(intervals); }
  [[nodiscard]] std::vector<Field> fields();

  friend bool operator==(const MeasurementPlan&, const MeasurementPlan&) = default;
};

/// Whether two runs were measured alike, so that their intervals can be merged: all but the start is the same.
bool compatible(const MeasurementPlan& a, const MeasurementPlan& b);

/// A plan whose cost is bounded: lags from `mean_free_time` / 50 to one interval, and as many origins as keep the
/// number of evaluations below one per four mean free times (at most 8). Sampling then takes about a twentieth of the
/// time of an engine that does 3 * 10^6 collisions/s at N = 10^4, less when intervals are longer. A function of its
/// arguments alone, not of the machine. Throws InputError when an interval is shorter than one mean free time.
MeasurementPlan plan_measurement(double start, double interval_length, std::uint64_t intervals, double mean_free_time,
                                 double lags_per_decade, std::vector<double> wavenumbers);

/// Frames of the static structure that cost about a hundredth of the run: one per 1500 mean free times, but 5 to 20. (A
/// frame takes as long as some 15 collisions of every disk where kicks are driving.)
std::uint64_t affordable_structure_frames(const MeasurementPlan& plan, double mean_free_time);

/// What is due at one moment of an interval. Evaluations at an offset come before new origins there; some new origins
/// are compared with themselves at once (lag 0).
struct Due {
  enum class Kind : std::uint8_t { evaluate, new_origin, new_compared_origin };
  double offset = 0;  ///< since the start of the interval
  Kind kind = Kind::evaluate;
  std::uint32_t level = 0;  ///< where the origin is kept
  std::uint32_t lag = 0;    ///< index into Schedule::lags (evaluate only)

  friend auto operator<=>(const Due&, const Due&) = default;
};

/// What is due, the same in every interval. Lags are log-spaced and end exactly at the interval length; lag 0 is first.
/// Level 0 holds the longest decade and has one origin, at the start of the interval; level l the decade below 10^-l of
/// the interval, with `origins` evenly spaced origins, each of which has done its lags when the next one comes.
struct Schedule {
  std::vector<double> lags;
  std::vector<std::uint32_t> level_of_lag;
  std::uint32_t levels = 0;
  std::vector<Due> due;                ///< by offset
  std::vector<std::uint64_t> origins;  ///< by lag: pairs of frames compared per interval

  [[nodiscard]] std::size_t evaluations() const;  ///< pairs of frames compared per interval, over all lags
  [[nodiscard]] std::size_t frames() const;       ///< distinct moments per interval
  /// The lag that is nearest to `time` by its logarithm; lag 0 never.
  [[nodiscard]] std::size_t nearest_lag(double time) const;
  /// One lag per decade, at most six, from the longest down.
  [[nodiscard]] std::vector<std::size_t> one_lag_per_decade() const;
};

Schedule make_schedule(const MeasurementPlan& plan);

/// The schedule for stored frames, `frames` steps of which make an interval (plan.interval_length): lags are whole
/// numbers of steps, log-spaced and the longest among them; every frame is an origin for all of them that end within
/// the interval, or every so manieth where an interval has more than `most_origins` frames, which bounds the memory.
/// `levels` counts the origins that are kept.
inline constexpr std::uint64_t most_origins = 128;
Schedule make_frame_schedule(const MeasurementPlan& plan, std::uint64_t frames);

}  // namespace sandglass
