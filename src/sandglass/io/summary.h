// summary.json: the outcome of a run in numbers and sentences.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace sandglass {

/// Averages are over the measured stretch, times in time units, temperatures as mean kinetic energy per disk. What was
/// not measured is NaN here and null in the file.
struct Summary {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  template <class T>
  struct BySpecies {
    T small{}, big{};
  };
  struct Temperature {
    double all = unknown, small = unknown, big = unknown;
  };
  struct Energy {  ///< per disk over the measured stretch
    double injected = unknown, dissipated = unknown;
    double balance = unknown;  ///< (injected - dissipated - change of kinetic energy) / injected
  };
  struct Calibration {
    double kick_amplitude = unknown, kick_frequency = unknown;
    std::uint64_t windows = 0;  ///< stretches that calibration measured
    double temperature_error = unknown;
  };
  struct Exponent {  ///< of the mean-square displacement, fitted over from < t < to
    double value = unknown, error = unknown, from = unknown, to = unknown;
  };

  struct Diffusion {  ///< (1/4) d MSD / ds, per collision of a disk
    double from_msd = unknown, error = unknown;
    double at_collisions = unknown;                    ///< s at which the slope is taken
    double from_vacf = unknown, vacf_error = unknown;  ///< the same from the integral of the VACF up to there
  };
  struct DiffusionByGroup {
    Diffusion small, big, all;
  };
  struct RelaxationTime {  ///< S_inc(k, tau) = 1/2
    double wavenumber = unknown;
    double small = unknown, error = unknown, big = unknown, big_error = unknown;
  };
  struct ByPair {  ///< of species
    double small_small = unknown, small_big = unknown, big_big = unknown;
  };
  struct PartnerRate {  ///< collisions per time of a disk of the first species with the second
    double small_small = unknown, small_big = unknown, big_small = unknown, big_big = unknown;
  };
  struct BondOrder {
    double global = unknown, local = unknown;
  };
  struct Anisotropy {  ///< of the main ring of S(k)
    double all = unknown, small = unknown;
  };

  bool from_frames = false;  ///< made from stored frames: what only a run knows is left out of the file
  std::string version;
  std::uint64_t seed = 0, particles = 0;
  double packing_fraction = unknown, restitution = unknown, box_length = unknown;
  double time = unknown;  ///< of the measured stretch
  std::uint64_t collisions = 0;
  double collisions_per_particle = unknown;
  Temperature temperature;
  double collision_rate = unknown;  ///< per disk and time
  double compressibility_factor = unknown;
  double kick_amplitude = unknown, kick_frequency = unknown;
  double elastic_collision_fraction = unknown;
  std::array<double, 2> momentum{unknown, unknown};  ///< total, at the end
  bool stationary = false;
  std::vector<std::pair<std::string, double>> errors;  ///< standard errors of the quantities named
  double wall_seconds = unknown, collisions_per_second = unknown;
  std::string state_hash;

  Calibration calibration;
  std::uint64_t kicks = 0, kicks_without_partner = 0;
  BySpecies<double> kick_rate{unknown, unknown};  ///< per disk of the species and time
  Energy energy;
  BySpecies<Exponent> msd_exponent;
  BySpecies<double> msd_unit_time{unknown, unknown};  ///< t at which the mean-square displacement is 1
  DiffusionByGroup diffusion;
  std::vector<RelaxationTime> relaxation_time;
  ByPair contact_value;
  PartnerRate collision_rate_by_pair;
  BondOrder bond_order;
  Anisotropy anisotropy;
  double velocity_correlation_length = unknown;
  double temperature_drift = unknown;  ///< relative change of T over the measured stretch
  std::vector<std::string> decisions;  ///< what the program decided by itself
  std::vector<std::string> warnings;
};

/// JSON with every number printed so that reading gives its bits back; NaN and infinities become null (and NaN again).
std::string to_json(const Summary& summary);
Summary summary_from_json(const std::string& text);  ///< throws InputError

/// The file, whole or not at all.
void write_summary(const std::filesystem::path& path, const Summary& summary);
Summary read_summary(const std::filesystem::path& path);

}  // namespace sandglass
