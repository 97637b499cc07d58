// The datasets of the StructureSampler: what observables.h5 holds under /structure.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "sandglass/observe/structure_sampler.h"

namespace sandglass {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Curve {
  std::vector<double> value, error;
};

Curve curve_of(const IntervalSeries& series) {
  Curve curve;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    const Estimate estimate = series.estimate(i);
    curve.value.push_back(estimate.value);
    curve.error.push_back(estimate.error);
  }
  return curve;
}

void append(std::vector<Dataset>& results, const std::string& path, std::vector<double> values, const char* unit) {
  results.push_back({path, {values.size()}, std::move(values), unit});
}

void append(std::vector<Dataset>& results, const std::string& path, const Estimate& estimate) {
  append(results, path, std::vector{estimate.value}, "");
  append(results, path + "_error", std::vector{estimate.error}, "");
}

}  // namespace

/// One value per finished block and abscissa.
template <class Value>
IntervalSeries StructureSampler::series(std::vector<double> abscissae, Value&& value) const {
  IntervalSeries result;
  result.time = std::move(abscissae);
  result.totals.resize(result.time.size());
  for (const std::size_t b : finished()) {
    ++result.intervals;
    for (std::size_t i = 0; i < result.time.size(); ++i) {
      result.means.push_back(value(b, i));
      result.totals[i] += result.means.back();
    }
  }
  return result;
}

std::vector<Dataset> StructureSampler::results() const {
  std::vector<Dataset> results;
  if (finished().empty()) return results;
  append_pairs(results);
  append_density(results);
  append_order(results);
  append_momenta(results);
  return results;
}

void StructureSampler::append_pairs(std::vector<Dataset>& results) const {
  const std::string path = "/structure/radial_distribution/";
  const double per_area = static_cast<double>(frames_per_block_) / (population_.box_length * population_.box_length);
  std::vector<double> r;
  for (std::size_t bin = 0; bin < bins_; ++bin) r.push_back((static_cast<double>(bin) + 0.5) * bin_width_);
  append(results, path + "r", r, "R_s");
  results.back().attributes = {{"bin_width", bin_width_},
                               {"frames", static_cast<double>(finished().size() * frames_per_block_)}};
  const auto add = [&](const std::string& name, std::size_t first, std::size_t last) {
    double pairs = 0;
    for (std::size_t pair = first; pair <= last; ++pair) pairs += pair_count(population_, pair);
    if (pairs == 0) return;
    std::vector<std::vector<double>> g(order_.size() / 2);  // by block
    for (const std::size_t b : finished()) {
      std::vector<std::uint64_t> counts(bins_);
      for (std::size_t pair = first; pair <= last; ++pair)
        for (std::size_t bin = 0; bin < bins_; ++bin)
          counts[bin] += pairs_[(b * species_pairs.size() + pair) * bins_ + bin];
      g[b] = radial_distribution(counts, 0, bin_width_, pairs * per_area);
    }
    Curve curve = curve_of(series(r, [&](std::size_t b, std::size_t bin) { return g[b][bin]; }));
    append(results, path + name, std::move(curve.value), "");
    append(results, path + name + "_error", std::move(curve.error), "");
  };
  add("all", 0, 2);
  for (std::size_t pair = 0; pair < species_pairs.size(); ++pair) {
    add(species_pairs[pair], pair, pair);
    if (pair_count(population_, pair) > 0)
      append(results, std::string("/structure/contact/") + species_pairs[pair], contact_value(pair));
  }
}

Estimate StructureSampler::contact_value(std::size_t pair) const {
  const std::vector<std::size_t> blocks = finished();
  const double contact = contact_distance(population_, pair);
  const double per_area = pair_count(population_, pair) * static_cast<double>(frames_per_block_) /
                          (population_.box_length * population_.box_length);
  if (blocks.empty() || per_area == 0) return {};
  const auto gaps_of = [&](std::size_t b) {
    return std::span(&gaps_[(b * species_pairs.size() + pair) * gap_bins], gap_bins);
  };
  std::vector<std::uint64_t> total(gap_bins);
  for (const std::size_t b : blocks)
    std::transform(total.begin(), total.end(), gaps_of(b).begin(), total.begin(), std::plus<>());
  const std::size_t bins =
      contact_bins(total, contact, per_area * static_cast<double>(blocks.size()), packing_fraction_);
  std::vector<double> values;
  values.reserve(blocks.size());
  for (const std::size_t b : blocks) values.push_back(sandglass::contact_value(gaps_of(b), bins, contact, per_area));
  return mean_of_intervals(values);
}

StructureFactor StructureSampler::mean_factor(Group group) const {
  StructureFactor factor = empty_factor_;
  const std::size_t modes = factor.values.size(), first = group == Group::small ? modes : 0;
  const auto taken = static_cast<double>(taken_ + merged_frames_);
  for (std::size_t k = 0; k < modes; ++k) factor.values[k] = map_[first + k].value() / taken;
  return factor;
}

double StructureSampler::anisotropy(Group group) const {
  if (taken_ + merged_frames_ == 0 || population_.range(group).size() == 0) return unknown;
  const StructureFactor factor = mean_factor(group);
  const RingAverage rings = ring_average(factor, ring_width_);
  const auto peak = std::max_element(rings.value.begin(), rings.value.end()) - rings.value.begin();
  return rings.value.empty() ? unknown : rings.anisotropy[static_cast<std::size_t>(peak)];
}

void StructureSampler::append_density(std::vector<Dataset>& results) const {
  const std::size_t rings = rings_.value.size();
  for (const Group group : {Group::all, Group::small}) {
    if (population_.range(group).size() == 0) continue;
    const std::size_t g = group == Group::small ? 1 : 0;
    const std::string path = "/structure/structure_factor/" + group_name(group) + "/";
    const StructureFactor factor = mean_factor(group);
    const auto side = static_cast<std::size_t>(2 * factor.modes + 1);
    std::vector<double> map;
    for (int m = -factor.modes; m <= factor.modes; ++m)
      for (int n = -factor.modes; n <= factor.modes; ++n) map.push_back(factor.at(m, n));
    results.push_back({path + "map", {side, side}, std::move(map), ""});
    append(results, path + "spacing", std::vector{factor.spacing}, "1/R_s");
    Curve curve = curve_of(series(rings_.wavenumber, [&](std::size_t b, std::size_t ring) {
      return ring_sums_[(b * 2 + g) * rings + ring].value() / static_cast<double>(frames_per_block_);
    }));
    append(results, path + "ring/wavenumber", rings_.wavenumber, "1/R_s");
    append(results, path + "ring/value", std::move(curve.value), "");
    append(results, path + "ring/error", std::move(curve.error), "");
    append(results, path + "ring/anisotropy", ring_average(factor, ring_width_).anisotropy, "");
    results.push_back({path + "ring/count", {rings}, rings_.count, ""});
  }
}

Estimate StructureSampler::order(std::size_t which) const {
  std::vector<double> values;
  for (const std::size_t b : finished())
    values.push_back(order_[2 * b + which].value() / static_cast<double>(frames_per_block_));
  return mean_of_intervals(values);
}

void StructureSampler::append_order(std::vector<Dataset>& results) const {
  const std::string path = "/structure/bond_order/";
  append(results, path + "global", global_bond_order());
  append(results, path + "local", local_bond_order());
  std::vector<std::uint64_t> count(order_bins_);
  std::vector<double> r(order_bins_), value(order_bins_), error(order_bins_);
  const std::vector<std::size_t> blocks = finished();
  for (std::size_t bin = 0; bin < order_bins_; ++bin) {
    // Pairs at one distance are few in some blocks: all pairs weigh alike, and the error is a jackknife over blocks.
    const auto mean = [&](std::size_t left_out) {
      double sum = 0, pairs = 0;
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (i == left_out) continue;
        sum += order_products_[blocks[i] * order_bins_ + bin].value();
        pairs += static_cast<double>(order_pairs_[blocks[i] * order_bins_ + bin]);
      }
      return pairs > 0 ? sum / pairs : unknown;
    };
    const Estimate estimate = jackknife(blocks.size(), mean);
    r[bin] = (static_cast<double>(bin) + 0.5) * order_bin_width;
    value[bin] = estimate.value, error[bin] = estimate.error;
    for (const std::size_t b : blocks) count[bin] += order_pairs_[b * order_bins_ + bin];
  }
  append(results, path + "correlation/r", std::move(r), "R_s");
  append(results, path + "correlation/value", std::move(value), "");
  append(results, path + "correlation/error", std::move(error), "");
  results.push_back({path + "correlation/count", {order_bins_}, std::move(count), ""});
}

IntervalSeries StructureSampler::momentum_series(std::size_t component) const {
  std::vector<double> wavenumbers;
  for (const WaveShell& shell : shells_) wavenumbers.push_back(shell.wavenumber);
  return series(std::move(wavenumbers), [&](std::size_t b, std::size_t shell) {
    return momenta_[(b * 2 + component) * shells_.size() + shell].value() / static_cast<double>(frames_per_block_);
  });
}

Estimate StructureSampler::velocity_correlation_length() const {
  return sandglass::velocity_correlation_length(momentum_series(0), population_.box_length);
}

void StructureSampler::append_momenta(std::vector<Dataset>& results) const {
  for (const std::size_t component : {0, 1}) {
    const std::string path = std::string("/structure/velocity/") + (component == 0 ? "transverse/" : "longitudinal/");
    const IntervalSeries values = momentum_series(component);
    Curve curve = curve_of(values);
    std::vector<std::uint64_t> count;
    for (const WaveShell& shell : shells_) count.push_back(shell.modes.size() * frames_per_block_ * values.intervals);
    append(results, path + "wavenumber", values.time, "1/R_s");
    append(results, path + "value", std::move(curve.value), "m_s R_s^2/t^2");
    append(results, path + "error", std::move(curve.error), "m_s R_s^2/t^2");
    results.push_back({path + "count", {shells_.size()}, std::move(count), ""});
  }
}

}  // namespace sandglass
