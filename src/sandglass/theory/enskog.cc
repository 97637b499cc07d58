#include "sandglass/theory/enskog.h"

#include <cmath>
#include <numbers>

namespace sandglass {
namespace {

double reduced_mass(const Mixture& mixture, int i, int j) {
  return mixture.mass[i] * mixture.mass[j] / (mixture.mass[i] + mixture.mass[j]);
}

/// Both species temperatures for a given ratio T_s / T_b and mean.
SpeciesValues split_temperature(double big_fraction, double mean, double ratio) {
  const double of_big = mean / ((1 - big_fraction) * ratio + big_fraction);
  return {ratio * of_big, of_big};
}

}  // namespace

CollisionRates collision_rates(const Mixture& mixture, double big_fraction, double packing_fraction,
                               const SpeciesValues& temperature) {
  const SpeciesValues x{1 - big_fraction, big_fraction};
  const auto chi = contact_values(mixture, big_fraction, packing_fraction);
  const double density = number_density(mixture, big_fraction, packing_fraction);
  CollisionRates rates;
  for (int i = 0; i < species_count; ++i) {
    for (int j = 0; j < species_count; ++j) {
      const double relative_speed = std::sqrt(temperature[i] / mixture.mass[i] + temperature[j] / mixture.mass[j]);
      rates.pair[i][j] = std::sqrt(2 * std::numbers::pi) * density * x[j] * (mixture.radius[i] + mixture.radius[j]) *
                         chi[i][j] * relative_speed;
      rates.species[i] += rates.pair[i][j];
    }
    rates.mean += x[i] * rates.species[i];
  }
  return rates;
}

double collision_rate(const Mixture& mixture, double big_fraction, double packing_fraction, double temperature) {
  return collision_rates(mixture, big_fraction, packing_fraction, {temperature, temperature}).mean;
}

double mean_free_time(const Mixture& mixture, double big_fraction, double packing_fraction, double temperature) {
  return 1 / collision_rate(mixture, big_fraction, packing_fraction, temperature);
}

double drive_amplitude(const Mixture& mixture, double big_fraction, double restitution, double temperature,
                       double frequency, double collision_rate) {
  const double mean_inverse_mass = (1 - big_fraction) / mixture.mass[small] + big_fraction / mixture.mass[big];
  const double loss = (1 - restitution * restitution) * temperature * collision_rate;
  return std::sqrt(loss / (2 * frequency * mean_inverse_mass));
}

SpeciesValues energy_loss(const Mixture& mixture, double big_fraction, double packing_fraction, double restitution,
                          const SpeciesValues& temperature) {
  const auto rates = collision_rates(mixture, big_fraction, packing_fraction, temperature);
  SpeciesValues loss{};
  for (int i = 0; i < species_count; ++i)
    for (int j = 0; j < species_count; ++j) {
      const double theta_i = temperature[i] / mixture.mass[i];
      const double theta_j = temperature[j] / mixture.mass[j];
      const double impulse = reduced_mass(mixture, i, j) * (1 + restitution);  // per unit of approach speed
      loss[i] += rates.pair[i][j] * 2 * impulse * (theta_i - impulse / (2 * mixture.mass[i]) * (theta_i + theta_j));
    }
  return loss;
}

DrivenState driven_steady_state(const Mixture& mixture, double big_fraction, double packing_fraction,
                                double restitution, double temperature, double kicks_per_collision,
                                const SpeciesValues& kick_share) {
  // In the steady state loss_i m_i / share_i = f p^2 is the same for both species. It grows with T_s/T_b for the small
  // and falls for the big disks, so that bisection of the ratio finds the one balance.
  const auto needed_drive = [&](const SpeciesValues& temperatures) {
    auto needed = energy_loss(mixture, big_fraction, packing_fraction, restitution, temperatures);
    for (int i = 0; i < species_count; ++i) needed[i] *= mixture.mass[i] / kick_share[i];
    return needed;
  };
  double low = 0, high = 64;
  for (int step = 0; step < 64; ++step) {
    const double ratio = (low + high) / 2;
    const auto needed = needed_drive(split_temperature(big_fraction, temperature, ratio));
    (needed[small] < needed[big] ? low : high) = ratio;
  }
  DrivenState steady;
  steady.temperature = split_temperature(big_fraction, temperature, (low + high) / 2);
  steady.rates = collision_rates(mixture, big_fraction, packing_fraction, steady.temperature);
  const auto needed = needed_drive(steady.temperature);
  const double drive = (1 - big_fraction) * needed[small] + big_fraction * needed[big];
  steady.amplitude = std::sqrt(drive / (kicks_per_collision * steady.rates.mean));
  return steady;
}

SpeciesValues velocity_decay_rates(const Mixture& mixture, const CollisionRates& rates, double restitution) {
  SpeciesValues decay{};
  for (int i = 0; i < species_count; ++i)
    for (int j = 0; j < species_count; ++j)
      decay[i] += (1 + restitution) * rates.pair[i][j] * reduced_mass(mixture, i, j) / mixture.mass[i];
  return decay;
}

double enskog_diffusion(const Mixture& mixture, double packing_fraction, double temperature, double restitution) {
  constexpr double sonine_correction = 1.026;  // beyond the first Sonine polynomial
  const double density = number_density(mixture, 0, packing_fraction);
  const double chi = contact_values(mixture, 0, packing_fraction)[small][small];
  const double diameter = 2 * mixture.radius[small];
  return sonine_correction * std::sqrt(temperature / (std::numbers::pi * mixture.mass[small])) /
         (2 * density * diameter * chi) * 2 / (1 + restitution);
}

double haff_time(double restitution, double initial_collision_rate) {
  return 4 / ((1 - restitution * restitution) * initial_collision_rate);
}

double white_noise_kurtosis(double restitution) {
  const double square = restitution * restitution;
  return 16 * (1 - restitution) * (1 - 2 * square) / (185 - 153 * restitution + 30 * (1 - restitution) * square);
}

}  // namespace sandglass
