#include "sandglass/theory/enskog.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numbers>

using namespace sandglass;

namespace {

const Mixture one_size{{1, 1}, {1, 1}};
const Mixture symmetric{};

/// A uniform random number in (low, high) for properties.
double random_between(double low, double high) { return low + (high - low) * (*rc::gen::inRange(1, 1'000'000)) / 1e6; }

Mixture random_mixture() {
  const double ratio = random_between(1, 3);
  return {{1, ratio}, {1, ratio * ratio}};
}

}  // namespace

TEST_CASE("collision rates") {
  // One size at low density: omega = 2 sqrt(pi) n s sqrt(T/m) = 8 eta / sqrt(pi) sqrt(T) / 2 ... with n = eta / pi, s =
  // 2: 4 eta sqrt(T / pi). chi = 1 + (25/16) eta + ... adds 1.6e-6 at eta = 1e-6.
  CHECK(std::fabs(collision_rate(one_size, 0.5, 1e-6, 4.0) / (4e-6 * std::sqrt(4 / std::numbers::pi)) - 1) < 2e-6);
  CHECK(mean_free_time(one_size, 0.5, 0.3, 1) * collision_rate(one_size, 0.5, 0.3, 1) == doctest::Approx(1));
  // The rate is wanted up to the densest start: growing and of order 100 there.
  double previous = 0;
  for (double eta = 0.01; eta < 0.845; eta += 0.01) {
    const double rate = collision_rate(symmetric, 0.5, eta, 1);
    CHECK(rate > previous);
    previous = rate;
  }
  CHECK(previous > 20);
  CHECK(previous < 200);

  CHECK(rc::check("as many collisions of s with b as of b with s; temperature enters as its square root", [] {
    const Mixture mixture = random_mixture();
    const double big_fraction = random_between(0, 1), eta = random_between(0, 0.84);
    const SpeciesValues temperature{random_between(0.1, 3), random_between(0.1, 3)};
    const auto rates = collision_rates(mixture, big_fraction, eta, temperature);
    const double of_small = (1 - big_fraction) * rates.pair[small][big];
    const double of_big = big_fraction * rates.pair[big][small];
    RC_ASSERT(std::fabs(of_small - of_big) <= 1e-14 * of_small);  // a handful of roundings
    const auto hotter = collision_rates(mixture, big_fraction, eta, {4 * temperature[0], 4 * temperature[1]});
    RC_ASSERT(std::fabs(hotter.mean - 2 * rates.mean) <= 1e-14 * hotter.mean);
  }));
}

TEST_CASE("drive amplitude") {
  // p^2 <|xi|^2> = 2 p^2 = 0.2552 at eps = 0.9, f = omega, T = 1 (four digits given).
  const double amplitude = drive_amplitude(symmetric, 0.5, 0.9, 1, 7.0, 7.0);
  CHECK(std::fabs(2 * amplitude * amplitude - 0.2552) < 5e-5);
  // Twice the temperature or half the frequency: twice the square.
  CHECK(drive_amplitude(symmetric, 0.5, 0.9, 2, 7, 7) == doctest::Approx(amplitude * std::sqrt(2.0)));
  CHECK(drive_amplitude(symmetric, 0.5, 0.9, 1, 3.5, 7) == doctest::Approx(amplitude * std::sqrt(2.0)));
  // One size: 2 p^2 = (1 - eps^2) m T.
  CHECK(2 * std::pow(drive_amplitude(one_size, 0.5, 0.5, 1, 1, 1), 2) == doctest::Approx(0.75));
}

TEST_CASE("energy balance of the species") {
  CHECK(rc::check("collisions lose (1 - eps^2) mu (theta_i + theta_j) / 2 each", [] {
    const Mixture mixture = random_mixture();
    const double x = random_between(0.05, 0.95), eta = random_between(0, 0.8), eps = random_between(0, 1);
    const SpeciesValues temperature{random_between(0.1, 3), random_between(0.1, 3)};
    const auto loss = energy_loss(mixture, x, eta, eps, temperature);
    const auto rates = collision_rates(mixture, x, eta, temperature);
    const SpeciesValues fraction{1 - x, x};
    double total = 0, scale = 0;
    for (int i = 0; i < species_count; ++i)
      for (int j = 0; j < species_count; ++j) {
        const double mu = mixture.mass[i] * mixture.mass[j] / (mixture.mass[i] + mixture.mass[j]);
        const double theta = temperature[i] / mixture.mass[i] + temperature[j] / mixture.mass[j];
        // <(g.n)^2> = 2 theta at contacts; mu (1-eps^2) <(g.n)^2> / 2 per collision, half of it per disk.
        total += fraction[i] * rates.pair[i][j] * mu * (1 - eps * eps) * theta / 2;
        scale += fraction[i] * rates.pair[i][j] * mu * theta;
      }
    RC_ASSERT(std::fabs((1 - x) * loss[small] + x * loss[big] - total) <= 1e-13 * scale);  // rounding
  }));

  CHECK(rc::check("the driven steady state balances in each species", [] {
    const Mixture mixture = random_mixture();
    const double x = random_between(0.05, 0.95), eta = random_between(0.01, 0.8), eps = random_between(0.3, 0.99);
    const double per_collision = random_between(0.5, 3), share = random_between(0.8, 1);
    const SpeciesValues kick_share{share, (1 - (1 - x) * share) / x};
    const auto steady = driven_steady_state(mixture, x, eta, eps, 1.5, per_collision, kick_share);
    const auto loss = energy_loss(mixture, x, eta, eps, steady.temperature);
    const double frequency = per_collision * steady.rates.mean;
    RC_ASSERT(std::fabs((1 - x) * steady.temperature[small] + x * steady.temperature[big] - 1.5) < 1e-14);
    for (int i = 0; i < species_count; ++i) {
      const double gain = kick_share[i] * frequency * steady.amplitude * steady.amplitude / mixture.mass[i];
      // The ratio is known to 64 / 2^64 absolutely, so what is left is rounding, magnified by the exchange between
      // species (omega T) over the loss (omega (1 - eps^2) T / 2): less than a factor 100 here.
      RC_ASSERT(std::fabs(gain - loss[i]) < 1e-11 * frequency);
    }
  }));

  // Disks of one size cannot differ, and the general first guess is then exact.
  const auto same = driven_steady_state(one_size, 0.3, 0.5, 0.8, 1);
  CHECK(same.temperature[small] == doctest::Approx(1).epsilon(1e-12));
  CHECK(same.amplitude == doctest::Approx(drive_amplitude(one_size, 0.3, 0.8, 1, 2, 2)).epsilon(1e-12));
  // Small disks are the hotter ones at the point where simulations have been made.
  const auto mixed = driven_steady_state(symmetric, 0.5, 0.5, 0.9, 1);
  CHECK(mixed.temperature[small] > mixed.temperature[big]);
  CHECK(mixed.temperature[small] / mixed.temperature[big] < 1.15);
}

TEST_CASE("diffusion and decay of velocities") {
  // First Sonine order: D = T / (m lambda); the printed factor 1.026 stands for the higher orders.
  for (const double eps : {1.0, 0.7}) {
    const auto rates = collision_rates(one_size, 0.5, 0.01, {2, 2});
    const double lambda = velocity_decay_rates(one_size, rates, eps)[small];
    CHECK(lambda == doctest::Approx(rates.mean * (1 + eps) / 2));
    CHECK(enskog_diffusion(one_size, 0.01, 2, eps) == doctest::Approx(1.026 * 2 / lambda));
  }
  // A light disk turns by more per collision than a heavy one; equal masses give 1 per elastic collision.
  const auto rates = collision_rates(symmetric, 0.5, 0.3, {1, 1});
  const auto decay = velocity_decay_rates(symmetric, rates, 1);
  CHECK(decay[small] / rates.species[small] > 1);
  CHECK(decay[big] / rates.species[big] < 1);
}

TEST_CASE("cooling and kurtosis") {
  // Energy loss at t = 0 is omega (1 - eps^2) T / 2, and that of Haff's law 2 T / tau.
  const double omega = collision_rate(one_size, 0.5, 0.2, 1);
  const auto loss = energy_loss(one_size, 0.5, 0.2, 0.9, {1, 1});
  CHECK(2 / haff_time(0.9, omega) == doctest::Approx(loss[small]));
  // Elastic: Maxwellian. It changes sign at eps^2 = 1/2 and is 16/185 for sticking disks.
  CHECK(white_noise_kurtosis(1) == 0);
  CHECK(std::fabs(white_noise_kurtosis(std::sqrt(0.5))) < 1e-15);
  CHECK(white_noise_kurtosis(0) == doctest::Approx(16.0 / 185));
  CHECK(white_noise_kurtosis(0.9) < 0);
}
