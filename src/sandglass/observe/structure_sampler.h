// Static structure on line: g(r), contact values, S(k), bond order and velocity structure factors, from a few frames.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sandglass/observe/interval_series.h"
#include "sandglass/observe/momentum_modes.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/population.h"
#include "sandglass/observe/schedule.h"
#include "sandglass/observe/structure.h"
#include "sandglass/observe/structure_factor.h"

namespace sandglass {

/// An Observer of plan.structure_frames frames, evenly spaced over the measured stretch. They are gathered in blocks of
/// equally many, between 5 and 20 where there are as many frames, whose scatter gives the errors; so that all fall into
/// one, their number is lowered a little where it must be. Bounded: pairs up to 20 R_s or half the box; wave vectors up
/// to 2 pi / R_s, every stride-th in a large box.
class StructureSampler {
 public:
  StructureSampler(const MeasurementPlan& plan, const Population& population);

  [[nodiscard]] double next_sample() const;
  void sample(const Frame& frame);
  /// Appends the blocks of an independent run that was measured alike; both must have taken all their frames. Throws
  /// RunError otherwise.
  void merge(const StructureSampler& other);
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const { return taken_ <= frames(); }  ///< after fields() were restored
  /// /structure/{radial_distribution, contact, structure_factor, bond_order, velocity}: docs/file-formats.md. Over
  /// finished blocks; nothing before the first one.
  [[nodiscard]] std::vector<Dataset> results() const;

  [[nodiscard]] std::uint64_t frames() const { return blocks_ * frames_per_block_; }
  [[nodiscard]] Estimate contact_value(std::size_t pair) const;  ///< NaN where the pair of species has no disks
  [[nodiscard]] Estimate global_bond_order() const { return order(0); }
  [[nodiscard]] Estimate local_bond_order() const { return order(1); }
  /// |<S e^{6 i phi}>| / <S> on the ring where the mean S(k) of the group (all or small) is largest.
  [[nodiscard]] double anisotropy(Group group) const;
  [[nodiscard]] Estimate velocity_correlation_length() const;

 private:
  static constexpr double order_bin_width = 0.25;  // in R_s
  void add_pairs(const Frame& frame);
  void add_density(const Frame& frame);
  void add_momenta(const Frame& frame);
  [[nodiscard]] std::uint64_t block() const { return taken_ / frames_per_block_; }
  /// Finished blocks, those of merged runs included.
  [[nodiscard]] std::vector<std::size_t> finished() const;
  template <class Value>
  [[nodiscard]] IntervalSeries series(std::vector<double> abscissae, Value&& value) const;
  [[nodiscard]] Estimate order(std::size_t which) const;
  [[nodiscard]] StructureFactor mean_factor(Group group) const;
  [[nodiscard]] IntervalSeries momentum_series(std::size_t component) const;
  void append_pairs(std::vector<Dataset>& results) const;
  void append_density(std::vector<Dataset>& results) const;
  void append_order(std::vector<Dataset>& results) const;
  void append_momenta(std::vector<Dataset>& results) const;

  MeasurementPlan plan_;
  Population population_;
  std::vector<std::uint8_t> species_;
  double packing_fraction_ = 0;
  std::uint64_t blocks_ = 0, frames_per_block_ = 1;
  double range_ = 0, bin_width_ = 0;
  std::size_t bins_ = 0, order_bins_ = 0;
  StructureFactor empty_factor_;  ///< how many modes there are, how far apart
  double ring_width_ = 0;
  RingAverage rings_;  ///< and which rings they make
  std::vector<WaveShell> shells_;
  Snapshot snapshot_;

  std::uint64_t taken_ = 0, merged_frames_ = 0;
  std::vector<std::uint64_t> pairs_;        ///< by distance [block, pair of species, bin]
  std::vector<std::uint64_t> gaps_;         ///< by gap [block, pair of species, bin]
  std::vector<ExactSum> map_;               ///< S(k) [all / small, mode]
  std::vector<ExactSum> ring_sums_;         ///< [block, all / small, ring]
  std::vector<ExactSum> order_;             ///< |<psi_6>|, <|psi_6|> [block, 2]
  std::vector<std::uint64_t> order_pairs_;  ///< [block, bin]
  std::vector<ExactSum> order_products_;    ///< Re psi_6* psi_6 of pairs [block, bin]
  std::vector<ExactSum> momenta_;           ///< [block, transverse / longitudinal, shell]
};
static_assert(Observer<StructureSampler>);

}  // namespace sandglass
