// A made-up run for tests: shapes as in a dense driven fluid (free flight, cage, slow escape), not a measurement.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sandglass/report/run_page.h"

namespace sandglass {

inline std::vector<Dataset> synthetic_results() {
  constexpr std::size_t lags = 84;
  const std::vector<double> wavenumbers{0.5, 3.0};
  constexpr double rate = 85, cage = 0.02, escape = 0.55;
  std::vector<double> time(lags), collisions(lags);
  for (std::size_t i = 0; i < lags; ++i) {
    time[i] = 1e-4 * std::pow(10.0, static_cast<double>(i) / 15);
    collisions[i] = rate * time[i];
  }
  std::vector<Dataset> results;
  auto add = [&](const std::string& path, std::vector<double> values, std::vector<std::size_t> shape) {
    results.push_back({path, std::move(shape), std::move(values), ""});
  };
  struct Kind {
    const char* name;
    double mass, size;
  };
  for (const Kind& kind : {Kind{"all", 1.35, 0.8}, Kind{"small", 1, 1}, Kind{"big", 2.0449, 0.6}}) {
    std::vector<double> square, square_error, velocity, velocity_error;
    for (const double t : time) {
      const double flight = 2 * t * t / kind.mass;
      const double caged = cage * kind.size * (1 + std::pow(t, escape) * 2);
      square.push_back(flight * caged / (flight + caged));
      square_error.push_back(0.01 * square.back() * (1 + t));
      velocity.push_back(2 / kind.mass * (std::exp(-60 * t) - 0.05 * std::exp(-8 * t) * (1 - std::exp(-40 * t))));
      velocity_error.push_back(0.002);
    }
    const std::string group = "/dynamics/" + std::string(kind.name);
    auto add_group = [&](const std::string& quantity, const std::vector<double>& value,
                         const std::vector<double>& error, std::vector<std::size_t> shape) {
      add(group + quantity + "/time", time, {lags});
      add(group + quantity + "/collisions", collisions, {lags});
      add(group + quantity + "/value", value, shape);
      if (!error.empty()) add(group + quantity + "/error", error, shape);
    };
    add_group("/mean_square_displacement", square, square_error, {lags});
    add_group("/velocity_autocorrelation", velocity, velocity_error, {lags});
    add(group + "/velocity_autocorrelation/equal_time_value", {2 / kind.mass}, {});
    std::vector<double> scattering, gaussian, error;
    for (const double k : wavenumbers) {
      for (const double s : square) {
        gaussian.push_back(std::exp(-k * k * s / 4));
        scattering.push_back(std::pow(gaussian.back(), 0.8));
        error.push_back(0.02 * (1 - scattering.back()));
      }
    }
    add_group("/self_intermediate_scattering", scattering, error, {wavenumbers.size(), lags});
    add(group + "/self_intermediate_scattering/wavenumber", wavenumbers, {wavenumbers.size()});
    add_group("/gaussian_approximation", gaussian, {}, {wavenumbers.size(), lags});
  }
  std::vector<double> start{0}, s{0}, all{1}, small{1}, big{1};
  for (int i = 0; i < 120; ++i) {
    const double t = 1e-3 * std::pow(10.0, i / 20.0);
    start.push_back(t);
    s.push_back(rate * t);
    small.push_back(1 + 0.02 * (1 - std::exp(-3 * t)) + 0.004 * std::sin(i));
    big.push_back(1 - 0.02 * (1 - std::exp(-3 * t)) + 0.004 * std::cos(i));
    all.push_back((small.back() + big.back()) / 2);
  }
  const std::vector<std::size_t> shape{start.size()};
  add("/timeseries/time", start, shape);
  add("/timeseries/collisions", s, shape);
  add("/timeseries/temperature_all", all, shape);
  add("/timeseries/temperature_small", small, shape);
  add("/timeseries/temperature_big", big, shape);
  return results;
}

inline Summary synthetic_summary() {
  Summary s;
  s.version = "0.1.0", s.seed = 7, s.particles = 10000, s.packing_fraction = 0.8, s.restitution = 0.9;
  s.box_length = 244.6, s.time = 118.2, s.collisions = 50000000, s.collisions_per_particle = 10000;
  s.temperature = {1.0012, 1.0204, 0.9821}, s.collision_rate = 84.6, s.compressibility_factor = 17.93;
  s.kick_amplitude = 0.3572, s.kick_frequency = 84.6, s.elastic_collision_fraction = 3.1e-5;
  s.momentum = {1.2e-12, -3.4e-13}, s.stationary = true, s.wall_seconds = 91, s.collisions_per_second = 1.1e6;
  s.errors = {{"temperature_all", 0.0021},
              {"temperature_small", 0.003},
              {"temperature_big", 0.003},
              {"collision_rate", 0.2},
              {"compressibility_factor", 0.04}};
  s.state_hash = "0123456789abcdef", s.kicks = 4300000, s.kick_rate = {79.1, 90.1};
  s.energy = {16.1, 16.09, 0.0002};
  s.msd_exponent = {{0.47, 0.011, 1, 10}, {0.45, 0.012, 1, 10}};
  s.msd_unit_time = {Summary::unknown, Summary::unknown}, s.temperature_drift = 0.004;
  s.decisions = {"The kick amplitude was calibrated to 0.3572 in 12 stretches of a scratch copy, then frozen."};
  s.warnings = {"The longest lag is shorter than the relaxation time: S_inc(3) has only fallen to 0.8."};
  return s;
}

/// About `count` disks on a square grid, species by turns.
inline State synthetic_state(std::size_t count) {
  State state;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  constexpr double spacing = 2.45;
  state.box_length = spacing * static_cast<double>(side);
  for (std::size_t i = 0; i < count; ++i) {
    Disk disk;
    disk.species = (i * 7919 / 13) % 2 == 0 ? small : big;
    disk.x = spacing * (static_cast<double>(i % side) + 0.1);
    disk.y = spacing * (static_cast<double>(i / side) + 0.1);
    state.disks.push_back(disk);
  }
  return state;
}

inline RunRecord synthetic_run(std::size_t disks = 10000) {
  return {synthetic_summary(), "[run]\nseed = 7\n", synthetic_results(), "", packing_of(synthetic_state(disks)), ""};
}

}  // namespace sandglass
