// The datasets of the Correlator: what observables.h5 holds under /dynamics.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sandglass/observe/correlator.h"
#include "sandglass/observe/fit.h"
#include "sandglass/observe/van_hove.h"

namespace sandglass {
namespace {

constexpr std::size_t most_stored_intervals = 100;

struct Curve {
  std::vector<double> value, error;

  void append(const Estimate& estimate) {
    value.push_back(estimate.value);
    error.push_back(estimate.error);
  }
};

// Every lag but lag 0.
Curve estimates(const IntervalSeries& series) {
  Curve curve;
  for (std::size_t lag = 1; lag < series.time.size(); ++lag) curve.append(series.estimate(lag));
  return curve;
}

// alpha_2 = <dr^4> / (2 <dr^2>^2) - 1, zero for a Gaussian in two dimensions.
Curve non_gaussian(const IntervalSeries& square, const IntervalSeries& fourth) {
  Curve curve;
  for (std::size_t lag = 1; lag < square.time.size(); ++lag) {
    curve.append(jackknife(square.intervals, [&](std::size_t left_out) {
      const double mean = square.mean(lag, left_out);
      return fourth.mean(lag, left_out) / (2 * mean * mean) - 1;
    }));
  }
  return curve;
}

IntervalSeries non_gaussian_by_interval(const IntervalSeries& square, const IntervalSeries& fourth) {
  IntervalSeries series = fourth;
  for (std::size_t i = 0; i < series.means.size(); ++i) {
    const double mean = square.means[i];
    series.means[i] = series.means[i] / (2 * mean * mean) - 1;
  }
  return series;
}

// D = (1/4) d MSD / dt at every lag.
Curve slopes(const IntervalSeries& displacements) {
  Curve curve;
  for (std::size_t lag = 1; lag < displacements.time.size(); ++lag)
    curve.append(diffusion_coefficient(displacements, displacements.time[lag]));
  return curve;
}

// chi_4 = N n / (n - 1) (<Q^2> - <Q>^2) over n pairs of moments: the variance that independent ones would have,
// unbiased.
Curve susceptibility(const IntervalSeries& overlap, const IntervalSeries& squared, std::size_t disks,
                     const std::vector<std::uint64_t>& moments_per_interval) {
  Curve curve;
  for (std::size_t lag = 1; lag < overlap.time.size(); ++lag) {
    curve.append(jackknife(overlap.intervals, [&](std::size_t left_out) {
      const double mean = overlap.mean(lag, left_out);
      const auto intervals = static_cast<double>(overlap.intervals - (left_out == no_interval ? 0 : 1));
      const double moments = intervals * static_cast<double>(moments_per_interval[lag]);
      return static_cast<double>(disks) * moments / (moments - 1) * (squared.mean(lag, left_out) - mean * mean);
    }));
  }
  return curve;
}

}  // namespace

/// The datasets of one group, appended one quantity after another.
class Correlator::Results {
 public:
  Results(const Correlator& correlator, Group group, std::vector<Dataset>& results)
      : self_(correlator), group_(group), results_(results) {
    const auto& lags = self_.schedule_.lags;
    time_.assign(lags.begin() + 1, lags.end());
    for (const double t : time_) collisions_.push_back(t * self_.collision_rate());
  }

  void append() {
    const IntervalSeries displacements = self_.mean_square_displacement(group_);
    const Curve displacement = estimates(displacements);
    const IntervalSeries fourth = self_.mean_fourth_displacement(group_);
    add_series("mean_square_displacement", displacements, "R_s^2");
    add("non_gaussian", non_gaussian(displacements, fourth), "");
    add_intervals("non_gaussian", {non_gaussian_by_interval(displacements, fourth)}, "");
    add("diffusion_coefficient", slopes(displacements), "R_s^2/t");
    add_series("cage_relative_displacement", self_.cage_relative_displacement(group_), "R_s^2", 1);
    add_series("running_diffusion", self_.running_diffusion(group_), "R_s^2/t");
    append_velocity();
    append_overlap();
    append_mobility();
    append_van_hove();
    append_scattering(displacement);
  }

 private:
  void add(const std::string& path, std::vector<std::size_t> shape, std::vector<double> values, const char* unit) {
    results_.push_back({place(path), std::move(shape), std::move(values), unit});
  }
  [[nodiscard]] std::string place(const std::string& name) const {
    return "/dynamics/" + group_name(group_) + "/" + name;
  }

  /// A curve over lags. `moments`: pairs of moments per interval at every lag, where it is not what the schedule says;
  /// `disks`: how many are averaged, where it is not the whole group.
  void add(const std::string& name, const Curve& curve, const char* unit, std::uint64_t moments = 0,
           std::size_t disks = 0) {
    const std::size_t lags = time_.size(), curves = curve.value.size() / lags;
    if (disks == 0) disks = self_.population_.range(group_).size();
    std::vector<std::uint64_t> count;
    for (std::size_t i = 0; i < curves; ++i)
      for (std::size_t lag = 1; lag <= lags; ++lag)
        count.push_back(self_.finished().size() * (moments > 0 ? moments : self_.schedule_.origins[lag]) * disks);
    const std::vector<std::size_t> shape =
        name.ends_with("scattering") || name.ends_with("approximation") ? std::vector{curves, lags} : std::vector{lags};
    add(name + "/time", {lags}, time_, "t");
    add(name + "/collisions", {lags}, collisions_, "");
    add(name + "/value", shape, curve.value, unit);
    add(name + "/error", shape, curve.error, unit);
    results_.push_back({place(name + "/count"), shape, std::move(count), ""});
  }

  /// Means, errors and each interval apart; the rest as for add().
  void add_series(const std::string& name, const IntervalSeries& series, const char* unit, std::uint64_t moments = 0,
                  std::size_t disks = 0) {
    add(name, estimates(series), unit, moments, disks);
    add_intervals(name, {series}, unit);
  }

  /// An attribute of the value of a quantity that is there.
  void note(const std::string& name, const char* attribute, double value) {
    const auto dataset = std::find_if(results_.rbegin(), results_.rend(),
                                      [&](const Dataset& d) { return d.path == place(name + "/value"); });
    dataset->attributes = {{attribute, value}};
  }

  /// Each interval apart, or blocks of them: what ages shows here. Shape [interval, lag], or [interval, k, lag].
  void add_intervals(const std::string& name, const std::vector<IntervalSeries>& series, const char* unit) {
    const std::size_t lags = time_.size();
    std::vector<BlockedSeries> blocks;
    for (const IntervalSeries& one : series) blocks.push_back(blocked(one, most_stored_intervals));
    std::vector<double> values;
    for (std::size_t b = 0; b < blocks[0].blocks; ++b)
      for (const BlockedSeries& one : blocks)
        values.insert(values.end(), one.means.begin() + static_cast<std::ptrdiff_t>(b * lags),
                      one.means.begin() + static_cast<std::ptrdiff_t>((b + 1) * lags));
    std::vector<std::size_t> shape{blocks[0].blocks, series.size(), lags};
    if (!name.ends_with("scattering")) shape.erase(shape.begin() + 1);
    add(name + "/interval_value", std::move(shape), std::move(values), unit);
    results_.back().attributes = {{"intervals_per_block", static_cast<double>(blocks[0].intervals_per_block)}};
  }

  void append_velocity() {
    const IntervalSeries series = self_.velocity_autocorrelation(group_);
    add_series("velocity_autocorrelation", series, "R_s^2/t^2");
    const Estimate equal_time = series.estimate(0);
    add("velocity_autocorrelation/equal_time_value", {1}, {equal_time.value}, "R_s^2/t^2");
    add("velocity_autocorrelation/equal_time_error", {1}, {equal_time.error}, "R_s^2/t^2");
  }

  void append_overlap() {
    const IntervalSeries overlap = self_.overlap(group_);
    add_series("overlap", overlap, "");
    note("overlap", "cutoff", self_.plan_.overlap_length);
    add("susceptibility",
        susceptibility(overlap, self_.squared_overlap(group_), self_.population_.range(group_).size(),
                       self_.schedule_.origins),
        "");
    note("susceptibility", "cutoff", self_.plan_.overlap_length);
  }

  void append_mobility() {
    for (const auto& [tail, name] :
         {std::pair{Mobility::fastest, "mobility/fastest"}, {Mobility::slowest, "mobility/slowest"}}) {
      add_series(name, self_.mobility(group_, tail), "R_s^2", 1, self_.mobility_.chosen(group_));
      note(name, "selection_time", self_.mobility_.selection_time());
    }
  }

  /// G_s(r, t) = <delta(r - |dr|)> / (2 pi r), integrated over each ring and divided by its area.
  void append_van_hove() {
    const std::vector<std::size_t>& lags = self_.histogram_lags_;
    const std::vector<std::size_t> intervals = self_.finished();
    const auto disks = static_cast<double>(self_.population_.range(group_).size());
    std::vector<double> r, edges, time, value, error;
    std::vector<std::uint64_t> count;
    for (std::size_t bin = 0; bin <= van_hove_bins; ++bin) edges.push_back(std::sqrt(van_hove_edge_squared(bin)));
    for (std::size_t bin = 0; bin < van_hove_bins; ++bin) r.push_back((edges[bin] + edges[bin + 1]) / 2);
    for (std::size_t i = 0; i < lags.size(); ++i) {
      time.push_back(self_.schedule_.lags[lags[i]]);
      const double pairs = static_cast<double>(self_.schedule_.origins[lags[i]]) * disks;
      for (std::size_t bin = 0; bin < van_hove_bins; ++bin) {
        const double area = std::numbers::pi * (van_hove_edge_squared(bin + 1) - van_hove_edge_squared(bin));
        std::vector<double> densities;
        count.push_back(0);
        for (const std::size_t interval : intervals) {
          const std::uint64_t counted = self_.counted(interval, i, bin, group_);
          densities.push_back(static_cast<double>(counted) / (pairs * area));
          count.back() += counted;
        }
        const Estimate density = mean_of_intervals(densities);
        value.push_back(density.value);
        error.push_back(density.error);
      }
    }
    add("van_hove/r", {van_hove_bins}, std::move(r), "R_s");
    add("van_hove/edges", {van_hove_bins + 1}, std::move(edges), "R_s");
    add("van_hove/time", {lags.size()}, std::move(time), "t");
    add("van_hove/value", {lags.size(), van_hove_bins}, std::move(value), "1/R_s^2");
    add("van_hove/error", {lags.size(), van_hove_bins}, std::move(error), "1/R_s^2");
    results_.push_back({place("van_hove/count"), {lags.size(), van_hove_bins}, std::move(count), ""});
  }

  void append_scattering(const Curve& displacement) {
    if (self_.shells_.empty()) return;
    Curve scattered, gaussian;
    std::vector<IntervalSeries> all;
    std::vector<double> wavenumbers;
    for (std::size_t k = 0; k < self_.shells_.size(); ++k) {
      const WaveShell& shell = self_.shells_[k];
      wavenumbers.push_back(shell.wavenumber);
      all.push_back(self_.self_intermediate_scattering(group_, k));
      for (std::size_t lag = 0; lag < time_.size(); ++lag) {
        scattered.append(all.back().estimate(lag + 1));
        const auto [value, derivative] =
            gaussian_approximation(shell, self_.population_.box_length, displacement.value[lag]);
        gaussian.append({value, -derivative * displacement.error[lag]});
      }
    }
    for (const char* name : {"self_intermediate_scattering", "gaussian_approximation"})
      add(std::string(name) + "/wavenumber", {wavenumbers.size()}, wavenumbers, "1/R_s");
    add("self_intermediate_scattering", scattered, "");
    add("gaussian_approximation", gaussian, "");
    add_intervals("self_intermediate_scattering", all, "");
  }

  const Correlator& self_;
  Group group_;
  std::vector<Dataset>& results_;
  std::vector<double> time_, collisions_;
};

std::vector<Dataset> Correlator::results() const {
  std::vector<Dataset> results;
  for (const Group group : groups)
    if (population_.range(group).size() > 0) Results(*this, group, results).append();

  // The waiting times of the stored intervals: from the start of the measured stretch to the middle of each.
  IntervalSeries middles;
  middles.time = {0, 0};
  for (const std::size_t interval : finished()) {
    ++middles.intervals;
    const double start = static_cast<double>(interval % plan_.intervals) * plan_.interval_length;
    middles.means.insert(middles.means.end(), {0, start + plan_.interval_length / 2});
  }
  BlockedSeries blocks = blocked(middles, most_stored_intervals);
  results.push_back({"/dynamics/waiting_time",
                     {blocks.blocks},
                     std::move(blocks.means),
                     "t",
                     {{"intervals_per_block", static_cast<double>(blocks.intervals_per_block)}}});
  return results;
}

}  // namespace sandglass
