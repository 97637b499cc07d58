// Pressure of the hard-disk fluid: virial series, contact values of the pair distribution, compressibility factors.
// Only + - * / and sqrt are used, so that time scales derived from these have the same bits on every machine.
#pragma once

#include <array>

#include "sandglass/core/state.h"

namespace sandglass {

/// One value per ordered pair of species, [i][j].
using PairValues = std::array<std::array<double, species_count>, species_count>;

/// Z = p / (n T) of elastic disks of one size as the truncated series 1 + sum_{k=2}^{10} b_k (2 eta)^(k-1), where
/// b_k = B_k / B_2^(k-1) [Clisby McCoy 2006]. Good to 0.6 % at packing fraction eta = 0.5, 3 % at 0.6.
double virial_series(double packing_fraction);

/// The Pade approximant [4/5] of that series: numerically exact up to eta = 0.6 or so, not to be used above 0.65
/// (Z = 4.106 at 0.5).
double virial_pade(double packing_fraction);

/// Disks per unit area, n = eta / (pi <R^2>). `big_fraction` is the number fraction x_b of big disks.
double number_density(const Mixture& mixture, double big_fraction, double packing_fraction);

/// Pair distribution at contact, chi_ij = 1/(1-eta) + (9/16) eta/(1-eta)^2 (s_i s_j / s_ij) <s>/<s^2>, s the diameters
/// and s_ij = (s_i + s_j)/2 [Jenkins Mancini 1987]. Off by about 1 % at eta = 0.5, 2 % at 0.6; finite for eta < 1.
/// \pre 0 <= packing_fraction < 1
PairValues contact_values(const Mixture& mixture, double big_fraction, double packing_fraction);

/// Z of the mixture with these contact values: Z - 1 = (1 + eps)/2 (pi/2) n sum_ij x_i x_j s_ij^2 chi_ij. For eps < 1
/// all species are taken at one temperature (for disks of one size Z - 1 = (1 + eps) eta chi).
double compressibility_factor(const Mixture& mixture, double big_fraction, double packing_fraction,
                              double restitution = 1);

/// Z of the elastic mixture from that of disks of one size (virial_pade) at the same packing fraction,
/// Z = (1 - xi) / (1 - eta) + xi Z_one, xi = <s>^2 / <s^2> [Santos 1999]. Exact to the second virial coefficient. For
/// the size ratio 1.43 in equal numbers Z - 1 is within 0.06 % of simulations at eta = 0.1 ... 0.6 (10^7 collisions
/// each, standard error 0.035 %) and 0.13 % low at 0.65.
double fluid_compressibility_factor(const Mixture& mixture, double big_fraction, double packing_fraction);

/// Z from given collision rates omega_ij (a disk of species i with any of species j) and temperatures T_i:
///   Z - 1 = (1 + eps)/2 sqrt(pi/8) sum_ij x_i omega_ij s_ij mu_ij sqrt(T_i/m_i + T_j/m_j) / T,
/// mu_ij the reduced mass, T the mean temperature. An exact relation in elastic equilibrium, at any density.
double compressibility_from_rates(const Mixture& mixture, double big_fraction, const PairValues& rates,
                                  const std::array<double, species_count>& temperature, double restitution = 1);

}  // namespace sandglass
