// The datasets of the Correlator: what observables.h5 holds under /dynamics.
#include <algorithm>
#include <utility>

#include "sandglass/observe/correlator.h"

namespace sandglass {
namespace {

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

}  // namespace

std::vector<Dataset> Correlator::results() const {
  std::vector<Dataset> results;
  for (const Group group : groups) {
    if (population_.range(group).size() > 0) append_results(results, group);
  }
  return results;
}

void Correlator::append_results(std::vector<Dataset>& results, Group group) const {
  const std::size_t lags = schedule_.lags.size() - 1, wavenumbers = shells_.size();
  const IntervalSeries displacements = mean_square_displacement(group);
  const std::vector<double> time(displacements.time.begin() + 1, displacements.time.end());
  std::vector<double> collisions = time;
  for (double& c : collisions) c *= collision_rate();
  std::vector<std::uint64_t> count(lags);
  for (std::size_t lag = 0; lag < lags; ++lag)
    count[lag] = displacements.intervals * schedule_.origins(schedule_.level_of_lag[lag + 1], plan_) *
                 population_.range(group).size();

  auto add = [&](const std::string& name, Curve curve, const std::string& unit, bool by_wavenumber) {
    const std::string path = "/dynamics/" + group_name(group) + "/" + name + "/";
    std::vector<std::size_t> shape{lags};
    std::vector<std::uint64_t> counts = count;
    if (by_wavenumber) {
      shape = {wavenumbers, lags};
      counts.clear();
      std::vector<double> k;
      for (const WaveShell& shell : shells_) {
        counts.insert(counts.end(), count.begin(), count.end());
        k.push_back(shell.wavenumber);
      }
      results.push_back({path + "wavenumber", {wavenumbers}, k, "1/R_s"});
    }
    results.push_back({path + "time", {lags}, time, "t"});
    results.push_back({path + "collisions", {lags}, collisions, ""});
    results.push_back({path + "value", shape, std::move(curve.value), unit});
    results.push_back({path + "error", shape, std::move(curve.error), unit});
    results.push_back({path + "count", shape, std::move(counts), ""});
  };

  const Curve displacement = estimates(displacements);
  add("mean_square_displacement", displacement, "R_s^2", false);
  add("non_gaussian", non_gaussian(displacements, mean_fourth_displacement(group)), "", false);

  const IntervalSeries velocity_series = velocity_autocorrelation(group);
  const std::string velocity_path = "/dynamics/" + group_name(group) + "/velocity_autocorrelation/";
  add("velocity_autocorrelation", estimates(velocity_series), "R_s^2/t^2", false);
  const Estimate equal_time = velocity_series.estimate(0);
  results.push_back({velocity_path + "equal_time_value", {1}, std::vector<double>{equal_time.value}, "R_s^2/t^2"});
  results.push_back({velocity_path + "equal_time_error", {1}, std::vector<double>{equal_time.error}, "R_s^2/t^2"});

  if (wavenumbers == 0) return;
  Curve scattered, gaussian;
  for (std::size_t k = 0; k < wavenumbers; ++k) {
    const IntervalSeries series = self_intermediate_scattering(group, k);
    for (std::size_t lag = 1; lag < series.time.size(); ++lag) {
      scattered.append(series.estimate(lag));
      const auto [value, derivative] =
          gaussian_approximation(shells_[k], population_.box_length, displacement.value[lag - 1]);
      gaussian.append({value, -derivative * displacement.error[lag - 1]});
    }
  }
  add("self_intermediate_scattering", std::move(scattered), "", true);
  add("gaussian_approximation", std::move(gaussian), "", true);
}

}  // namespace sandglass
