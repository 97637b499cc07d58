// Kinetic theory of dense hard-disk mixtures in the Enskog approximation: collision rates, the energy balance of
// the driven steady state, first decay of velocities, diffusion. Small disks have R_s = m_s = 1; T is the mean kinetic
// energy per disk. Only + - * / and sqrt are used: time scales that shape trajectories are taken from here.
#pragma once

#include <array>

#include "sandglass/core/state.h"
#include "sandglass/theory/equation_of_state.h"

namespace sandglass {

/// One value per species.
using SpeciesValues = std::array<double, species_count>;

/// Collision rates in the Enskog approximation; each collision counts for both its disks.
struct CollisionRates {
  PairValues pair{};        ///< omega_ij: rate at which one disk of species i meets disks of species j
  SpeciesValues species{};  ///< omega_i = sum_j omega_ij
  double mean = 0;          ///< omega = sum_i x_i omega_i, per disk and time
};

/// omega_ij = sqrt(2 pi) n x_j s_ij chi_ij sqrt(T_i/m_i + T_j/m_j), s_ij = R_i + R_j. Within 1-2 % of elastic fluids up
/// to packing fraction 0.6; finite and of the right order up to 0.84.
CollisionRates collision_rates(const Mixture& mixture, double big_fraction, double packing_fraction,
                               const SpeciesValues& temperature);

/// Mean collision rate per disk, all species at one temperature; and its inverse, the beat of a run.
double collision_rate(const Mixture& mixture, double big_fraction, double packing_fraction, double temperature);
double mean_free_time(const Mixture& mixture, double big_fraction, double packing_fraction, double temperature);

/// First guess of p_Dr, the standard deviation of one component of a kick's momentum (Drive::amplitude). With species
/// at one temperature, injection f 2 p^2 <1/m> / 2 and dissipation omega (1 - eps^2) T / 2 balance when
///   2 p^2 = (1 - eps^2) T (omega / f) / <1/m>,   <1/m> = sum_i x_i / m_i
/// (= 2 (1 - eps^2) / (1/m_s + 1/m_b) for equal numbers, f = omega and T = 1). `frequency` is f_Dr, the rate at which a
/// disk is kicked.
double drive_amplitude(const Mixture& mixture, double big_fraction, double restitution, double temperature,
                       double frequency, double collision_rate);

/// Energy lost per time by one disk of each species to collisions (negative: gained from the other species),
///   sum_j omega_ij 2 mu (1 + eps) [theta_i - mu (1 + eps) / (2 m_i) (theta_i + theta_j)],  theta_i = T_i/m_i.
SpeciesValues energy_loss(const Mixture& mixture, double big_fraction, double packing_fraction, double restitution,
                          const SpeciesValues& temperature);

/// A driven steady state: species temperatures with x_s T_s + x_b T_b = T, and what drives it.
struct DrivenState {
  SpeciesValues temperature{};
  CollisionRates rates;
  double amplitude = 0;  ///< p_Dr as in Drive::amplitude
};

/// The steady state in which the kicks, f_i p^2 / m_i per disk and time, balance energy_loss in each species. Kicks
/// come at f = kicks_per_collision * omega on average, and at f_i = kick_share[i] * f for species i (the nearest
/// neighbour is more often big: about 0.93 and 1.07). Kicks of neighbour pairs deviate by a few per cent, being
/// correlated. \pre restitution < 1, kicks_per_collision > 0, kick_share > 0
DrivenState driven_steady_state(const Mixture& mixture, double big_fraction, double packing_fraction,
                                double restitution, double temperature, double kicks_per_collision = 1,
                                const SpeciesValues& kick_share = {1, 1});

/// Initial decay rate of the velocity autocorrelation, -d ln <v(0).v(t)>/dt at 0+, by species:
/// (1 + eps) sum_j omega_ij m_j / (m_i + m_j). Molecular chaos; any ratio of temperatures. Kicks don't change it.
SpeciesValues velocity_decay_rates(const Mixture& mixture, const CollisionRates& rates, double restitution);

/// Self-diffusion of elastic disks of one size, D = 1.026 sqrt(T/(pi m)) / (2 n s chi), for inelastic ones times
/// 2/(1 + eps); in R_s^2 per time. For low density: correlated collisions and the long-time tail are left out.
/// \pre mixture of one size: radius[small] == radius[big], mass[small] == mass[big]
double enskog_diffusion(const Mixture& mixture, double packing_fraction, double temperature, double restitution = 1);

/// Haff's law of free cooling before clusters form, disks of one size: T = T_0 / (1 + t/tau)^2 with
/// 1/tau = (1 - eps^2) omega_0 / 4. [Haff 1983]
double haff_time(double restitution, double initial_collision_rate);

/// Excess kurtosis a2 = <v^4> / (2 <v^2>^2) - 1 of disks of one size under white noise (f_Dr >> omega), low density:
/// a2 = 16 (1-eps)(1-2 eps^2) / (185 - 153 eps + 30 (1-eps) eps^2). [van Noije Ernst 1998]
double white_noise_kurtosis(double restitution);

}  // namespace sandglass
