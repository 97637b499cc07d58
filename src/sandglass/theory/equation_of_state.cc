#include "sandglass/theory/equation_of_state.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace sandglass {
namespace {

/// Coefficients of Z in powers of 2 eta. [Clisby McCoy 2006]
constexpr std::array virial{1.0,       1.0,       0.782004,  0.53223180, 0.33355604,
                            0.1988425, 0.1148728, 0.0649930, 0.0362193,  0.0199537};
constexpr std::size_t numerator_degree = 4, denominator_degree = 5;
static_assert(numerator_degree + denominator_degree + 1 == virial.size());

struct Pade {
  std::array<double, numerator_degree + 1> numerator{};
  std::array<double, denominator_degree + 1> denominator{};
};

/// Denominator q (q_0 = 1) from the vanishing of the coefficients of (2 eta)^5 ... (2 eta)^9 in q Z, by Gaussian
/// elimination with row pivoting; the numerator is q Z below that. Done by the compiler.
constexpr Pade derive_pade() {
  constexpr std::size_t size = denominator_degree;
  std::array<std::array<double, size + 1>, size> row{};  // the last column is the right-hand side
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) row[i][j] = virial[numerator_degree + i - j];
    row[i][size] = -virial[numerator_degree + 1 + i];
  }
  constexpr auto magnitude = [](double value) { return value < 0 ? -value : value; };
  for (std::size_t pivot = 0; pivot < size; ++pivot) {
    for (std::size_t i = pivot + 1; i < size; ++i)
      if (magnitude(row[i][pivot]) > magnitude(row[pivot][pivot])) std::swap(row[i], row[pivot]);
    for (std::size_t i = pivot + 1; i < size; ++i) {
      const double factor = row[i][pivot] / row[pivot][pivot];
      for (std::size_t j = pivot; j <= size; ++j) row[i][j] -= factor * row[pivot][j];
    }
  }
  Pade pade;
  pade.denominator[0] = 1;
  for (std::size_t i = size; i-- > 0;) {
    double value = row[i][size];
    for (std::size_t j = i + 1; j < size; ++j) value -= row[i][j] * pade.denominator[j + 1];
    pade.denominator[i + 1] = value / row[i][i];
  }
  for (std::size_t k = 0; k <= numerator_degree; ++k)
    for (std::size_t j = 0; j <= k; ++j) pade.numerator[k] += pade.denominator[j] * virial[k - j];
  return pade;
}

template <std::size_t Size>
double polynomial(const std::array<double, Size>& coefficients, double x) {
  double value = 0;
  for (std::size_t k = Size; k-- > 0;) value = value * x + coefficients[k];
  return value;
}

std::array<double, species_count> fractions(double big_fraction) { return {1 - big_fraction, big_fraction}; }

}  // namespace

double virial_series(double packing_fraction) { return polynomial(virial, 2 * packing_fraction); }

double virial_pade(double packing_fraction) {
  static constexpr Pade pade = derive_pade();
  return polynomial(pade.numerator, 2 * packing_fraction) / polynomial(pade.denominator, 2 * packing_fraction);
}

double number_density(const Mixture& mixture, double big_fraction, double packing_fraction) {
  const auto& radius = mixture.radius;
  const double mean_square =
      (1 - big_fraction) * radius[small] * radius[small] + big_fraction * radius[big] * radius[big];
  return packing_fraction / (std::numbers::pi * mean_square);
}

PairValues contact_values(const Mixture& mixture, double big_fraction, double packing_fraction) {
  const auto x = fractions(big_fraction);
  const auto& radius = mixture.radius;
  const double mean = x[small] * radius[small] + x[big] * radius[big];
  const double mean_square = x[small] * radius[small] * radius[small] + x[big] * radius[big] * radius[big];
  const double empty = 1 - packing_fraction;
  PairValues chi{};
  for (int i = 0; i < species_count; ++i)
    for (int j = 0; j < species_count; ++j) {
      const double harmonic = 2 * radius[i] * radius[j] / (radius[i] + radius[j]);
      chi[i][j] = 1 / empty + 9.0 / 16 * packing_fraction / (empty * empty) * harmonic * mean / mean_square;
    }
  return chi;
}

double compressibility_factor(const Mixture& mixture, double big_fraction, double packing_fraction,
                              double restitution) {
  const auto x = fractions(big_fraction);
  const auto chi = contact_values(mixture, big_fraction, packing_fraction);
  double sum = 0;
  for (int i = 0; i < species_count; ++i)
    for (int j = 0; j < species_count; ++j) {
      const double distance = mixture.radius[i] + mixture.radius[j];
      sum += x[i] * x[j] * distance * distance * chi[i][j];
    }
  const double density = number_density(mixture, big_fraction, packing_fraction);
  return 1 + (1 + restitution) / 2 * std::numbers::pi / 2 * density * sum;
}

double fluid_compressibility_factor(const Mixture& mixture, double big_fraction, double packing_fraction) {
  const auto x = fractions(big_fraction);
  const auto& radius = mixture.radius;
  const double mean = x[small] * radius[small] + x[big] * radius[big];
  const double mean_square = x[small] * radius[small] * radius[small] + x[big] * radius[big] * radius[big];
  const double alike = mean * mean / mean_square;
  return (1 - alike) / (1 - packing_fraction) + alike * virial_pade(packing_fraction);
}

double compressibility_from_rates(const Mixture& mixture, double big_fraction, const PairValues& rates,
                                  const std::array<double, species_count>& temperature, double restitution) {
  const auto x = fractions(big_fraction);
  const auto& mass = mixture.mass;
  double sum = 0;
  for (int i = 0; i < species_count; ++i)
    for (int j = 0; j < species_count; ++j) {
      const double reduced_mass = mass[i] * mass[j] / (mass[i] + mass[j]);
      const double relative_speed = std::sqrt(temperature[i] / mass[i] + temperature[j] / mass[j]);
      sum += x[i] * rates[i][j] * (mixture.radius[i] + mixture.radius[j]) * reduced_mass * relative_speed;
    }
  const double mean_temperature = x[small] * temperature[small] + x[big] * temperature[big];
  return 1 + (1 + restitution) / 2 * std::sqrt(std::numbers::pi / 8) * sum / mean_temperature;
}

}  // namespace sandglass
