#include "sandglass/observe/structure_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/observe/bond_order.h"
#include "sandglass/observe/cells.h"

namespace sandglass {
namespace {

constexpr double pair_range = 20;                            // in R_s
constexpr double longest_wavenumber = 2 * std::numbers::pi;  // in 1/R_s
constexpr double least_ring_width = 0.05, longest_momentum_wavenumber = 2.5;
constexpr double widest_default_bin = 0.4;  // L / 800 is the paper's at 10^4 disks; far larger boxes need finer ones
constexpr int most_modes = 96;
constexpr std::array<Group, 2> factor_groups{Group::all, Group::small};

double area_of_disks(const Population& population) {
  double area = 0;
  for (const Species species : {small, big}) {
    const double radius = population.mixture.radius[species];
    area += std::numbers::pi * radius * radius * static_cast<double>(population.range(species).size());
  }
  return area;
}

/// The number of blocks that leaves the fewest frames over; of equals the largest.
std::uint64_t block_count(std::uint64_t frames) {
  std::uint64_t best = std::min<std::uint64_t>(frames, 5);
  for (std::uint64_t blocks = std::max<std::uint64_t>(best, 1); blocks <= std::min<std::uint64_t>(frames, 20); ++blocks)
    if (frames / blocks * blocks >= frames / best * best) best = blocks;
  return best;
}

}  // namespace

StructureSampler::StructureSampler(const MeasurementPlan& plan, const Population& population)
    : plan_(plan), population_(population), species_(species_by_id(population)) {
  const double length = population.box_length;
  packing_fraction_ = area_of_disks(population) / (length * length);
  blocks_ = block_count(plan.structure_frames);
  frames_per_block_ = blocks_ > 0 ? plan.structure_frames / blocks_ : 1;
  range_ = std::min(pair_range, length / 2);
  bin_width_ = plan.bin_width > 0 ? std::min(plan.bin_width, range_) : std::min(length / 800, widest_default_bin);
  bins_ = static_cast<std::size_t>(range_ / bin_width_ + 1e-9);
  order_bins_ = static_cast<std::size_t>(range_ / order_bin_width);
  const DensityModes none =
      density_modes({}, Population{length, population.mixture, {}, 0}, longest_wavenumber, most_modes);
  const std::size_t modes = none.real[small].size();
  empty_factor_ = {none.modes, none.spacing, std::vector<double>(modes)};
  ring_width_ = std::max(least_ring_width, none.spacing);
  rings_ = ring_average(empty_factor_, ring_width_);
  shells_ = momentum_shells(length, longest_momentum_wavenumber);

  pairs_.resize(blocks_ * species_pairs.size() * bins_);
  gaps_.resize(blocks_ * species_pairs.size() * gap_bins);
  map_.resize(factor_groups.size() * modes);
  ring_sums_.resize(blocks_ * factor_groups.size() * rings_.value.size());
  order_.resize(blocks_ * 2);
  order_pairs_.resize(blocks_ * order_bins_);
  order_products_.resize(blocks_ * order_bins_);
  momenta_.resize(blocks_ * 2 * shells_.size());
}

double StructureSampler::next_sample() const {
  if (taken_ >= frames()) return std::numeric_limits<double>::infinity();
  const double spacing = (plan_.end() - plan_.start) / static_cast<double>(frames());
  return plan_.start + (static_cast<double>(taken_) + 0.5) * spacing;
}

void StructureSampler::sample(const Frame& frame) {
  if (taken_ >= frames()) return;
  add_pairs(frame);
  add_density(frame);
  add_momenta(frame);
  ++taken_;
}

void StructureSampler::add_pairs(const Frame& frame) {
  const std::vector<std::complex<double>> psi = bond_order(frame, population_);
  order_[2 * block()].add(sandglass::global_bond_order(psi));
  order_[2 * block() + 1].add(sandglass::local_bond_order(psi));

  std::uint64_t* pairs = &pairs_[block() * species_pairs.size() * bins_];
  std::uint64_t* gaps = &gaps_[block() * species_pairs.size() * gap_bins];
  std::uint64_t* order_pairs = &order_pairs_[block() * order_bins_];
  ExactSum* order_products = &order_products_[block() * order_bins_];
  std::array<double, 3> contact{}, bins_per_gap{};
  for (std::size_t pair = 0; pair < species_pairs.size(); ++pair) {
    contact[pair] = contact_distance(population_, pair);
    bins_per_gap[pair] = gap_bins / (gap_range * contact[pair]);
  }
  const double bins_per_length = 1 / bin_width_, order_bins_per_length = 1 / order_bin_width;
  const Cells cells(frame.x, frame.y, population_.box_length, range_ / 4);
  std::vector<std::uint8_t> species;
  std::vector<std::complex<double>> order;
  for (const std::uint32_t id : cells.order()) species.push_back(species_[id]), order.push_back(psi[id]);
  std::vector<double> products(order_bins_);
  cells.for_each_pair(range_, [&](std::size_t a, std::size_t b, double squared) {
    const double distance = std::sqrt(squared);
    const std::size_t pair = species[a] + species[b];
    const auto bin = static_cast<std::size_t>(static_cast<std::int64_t>(distance * bins_per_length));
    if (bin < bins_) ++pairs[pair * bins_ + bin];
    // Rounding leaves disks that touch closer by a hair; points that are no disks may overlap.
    const double gap = (distance - contact[pair]) * bins_per_gap[pair];
    if (gap > -1e-3 && gap < gap_bins) ++gaps[pair * gap_bins + static_cast<std::size_t>(std::max(0.0, gap))];
    const auto order_bin = static_cast<std::size_t>(static_cast<std::int64_t>(distance * order_bins_per_length));
    if (order_bin < order_bins_) {
      ++order_pairs[order_bin];
      products[order_bin] += order[a].real() * order[b].real() + order[a].imag() * order[b].imag();
    }
  });
  for (std::size_t bin = 0; bin < order_bins_; ++bin) order_products[bin].add(products[bin]);
}

void StructureSampler::add_density(const Frame& frame) {
  const DensityModes modes = density_modes(frame, population_, longest_wavenumber, most_modes);
  for (std::size_t g = 0; g < factor_groups.size(); ++g) {
    if (population_.range(factor_groups[g]).size() == 0) continue;
    const StructureFactor factor = structure_factor(modes, factor_groups[g]);
    for (std::size_t k = 0; k < factor.values.size(); ++k) map_[g * factor.values.size() + k].add(factor.values[k]);
    const RingAverage rings = ring_average(factor, ring_width_);
    ExactSum* sums = &ring_sums_[(block() * factor_groups.size() + g) * rings_.value.size()];
    for (std::size_t ring = 0; ring < rings.value.size(); ++ring) sums[ring].add(rings.value[ring]);
  }
}

void StructureSampler::add_momenta(const Frame& frame) {
  take_snapshot(frame, population_, snapshot_);
  const MomentumStructure structure = momentum_structure(snapshot_, population_, shells_);
  ExactSum* sums = &momenta_[block() * 2 * shells_.size()];
  for (std::size_t shell = 0; shell < shells_.size(); ++shell) {
    sums[shell].add(structure.transverse[shell]);
    sums[shells_.size() + shell].add(structure.longitudinal[shell]);
  }
}

void StructureSampler::merge(const StructureSampler& other) {
  if (!compatible(plan_, other.plan_) || population_.order != other.population_.order || taken_ < frames() ||
      other.taken_ < other.frames())
    throw RunError(
        "Two runs measured by different plans, with different disks, or not to their end cannot be merged; merge "
        "finished runs of one configuration that differ in their seed alone.");
  const auto append = [](auto& mine, const auto& theirs) { mine.insert(mine.end(), theirs.begin(), theirs.end()); };
  append(pairs_, other.pairs_);
  append(gaps_, other.gaps_);
  append(ring_sums_, other.ring_sums_);
  append(order_, other.order_);
  append(order_pairs_, other.order_pairs_);
  append(order_products_, other.order_products_);
  append(momenta_, other.momenta_);
  for (std::size_t k = 0; k < map_.size(); ++k) map_[k].add(other.map_[k]);
  merged_frames_ += other.taken_ + other.merged_frames_;
}

std::vector<Field> StructureSampler::fields() {
  return {{"taken", &taken_},
          {"merged_frames", &merged_frames_},
          {"pairs", &pairs_},
          {"gaps", &gaps_},
          {"map", &map_},
          {"rings", &ring_sums_},
          {"order", &order_},
          {"order_pairs", &order_pairs_},
          {"order_products", &order_products_},
          {"momenta", &momenta_}};
}

std::vector<std::size_t> StructureSampler::finished() const {
  std::vector<std::size_t> list;
  for (std::size_t b = 0; b < order_.size() / 2; ++b)
    if (b < block() || b >= blocks_) list.push_back(b);
  return list;
}

}  // namespace sandglass
