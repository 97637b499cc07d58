// Dynamic heterogeneity: how far the fastest and the slowest tenth of the disks go.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// Mean square displacements, from the start of each interval, of the tenth of the disks that have gone farthest, and
/// of the tenth that have gone least, at one lag (of equal displacements the disk first in the population counts as
/// less far). Which disks these are is known only then, so the squares of all earlier lags are kept, for at most
/// `most_followed` disks evenly taken from the population: up to 80 kB per lag.
class Mobility {
 public:
  static constexpr std::size_t most_followed = 10000;

  /// \param selection index of the lag at which disks are chosen
  Mobility(std::vector<double> lags, std::size_t selection, const Population& population, std::uint64_t intervals);

  /// Notes the displacements at one lag.
  void add(std::size_t lag, const Snapshot& origin, const Snapshot& now);
  /// Chooses, at the end of an interval.
  void finish(std::uint64_t interval);

  /// Appends `intervals` intervals of `other` from `first` on.
  void append(const Mobility& other, std::size_t first, std::size_t intervals);
  [[nodiscard]] std::vector<Field> fields();

  enum Tail : std::size_t { fastest = 0, slowest = 1 };
  /// Sum over the chosen disks of an interval; divided by chosen(group) it is their mean square displacement.
  [[nodiscard]] double sum(std::size_t interval, std::size_t lag, Group group, Tail tail) const;
  [[nodiscard]] std::size_t chosen(Group group) const;
  [[nodiscard]] double selection_time() const { return lags_[selection_]; }

 private:
  [[nodiscard]] std::size_t slot(std::size_t interval, std::size_t lag, Group group, Tail tail) const;
  void choose(std::uint64_t interval, Group group);

  std::vector<double> lags_;
  std::size_t selection_;
  std::vector<std::uint32_t> followed_;  ///< places in the population, rising
  std::size_t small_followed_ = 0;
  std::vector<double> squares_;  ///< (s |dr|)^2 of this interval [lag, followed]
  std::vector<ExactSum> sums_;   ///< [interval, lag, group, tail]
};

}  // namespace sandglass
