// The State: all that a run is, as plain data. The only thing that crosses module borders.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sandglass/core/exact_sum.h"

namespace sandglass {

/// The two kinds of disk. Index into every array "by species".
enum Species : std::uint8_t { small = 0, big = 1 };
inline constexpr int species_count = 2;

/// Radius and mass by species, in units of the small disks (R_s = m_s = 1). Equal mass density: m_b = R_b^2.
struct Mixture {
  std::array<double, species_count> radius{1.0, 1.43};
  std::array<double, species_count> mass{1.0, 1.43 * 1.43};
};

/// The canonical record of one disk. It changes only at the disk's own contacts, kicks and transits and at epochs, so
/// that it is a function of the physics alone. Times are counted from the start of the current epoch.
struct Disk {
  double x = 0, y = 0;                                             ///< centre at `time`, in [0, L)
  double vx = 0, vy = 0;                                           ///< velocity since `time`
  double time = 0;                                                 ///< when this record last changed
  double last_contact = -std::numeric_limits<double>::infinity();  ///< time of the latest collision (for the TC model)
  double next_kick = std::numeric_limits<double>::infinity();      ///< when this disk's own kick clock rings next
  std::uint64_t kick_count = 0;           ///< rings so far; the counter of the disk's random stream
  std::int32_t image_x = 0, image_y = 0;  ///< unwrapped position is x + image_x * L
  Species species = small;
};

enum class CollapsePolicy : std::uint8_t { none, tc };
enum class DriveKind : std::uint8_t { none, pair, single };
enum class PartnerRule : std::uint8_t { nearest, within };

/// The collision law: normal restitution and what prevents the inelastic collapse.
struct CollisionLaw {
  double restitution = 1;
  CollapsePolicy collapse = CollapsePolicy::none;
  double collapse_time = 0;  ///< t_c of the TC model, in time units
};

/// The driving, with the values that calibration froze.
struct Drive {
  DriveKind kind = DriveKind::none;
  PartnerRule partner = PartnerRule::nearest;
  double reach = 2;      ///< partners are taken within reach * (R_i + R_j), centre to centre (PartnerRule::within)
  double frequency = 0;  ///< f_Dr: mean rate at which a disk is kicked, as first or second of a pair
  double amplitude = 0;  ///< p_Dr: standard deviation of each component of the momentum of a kick
};

/// Exact counts and sums over all events since the start of the run. Averages are differences of two tallies.
struct Tally {
  std::array<std::uint64_t, 3> contacts{};            ///< collisions by pair of species: ss, sb, bb
  std::uint64_t elastic_contacts = 0;                 ///< made elastic by the TC model
  std::array<std::uint64_t, species_count> kicked{};  ///< disks kicked, as first or second of a pair
  std::uint64_t kicks = 0;                            ///< kick events that acted
  std::uint64_t kicks_without_partner = 0;            ///< rings skipped because nobody was within reach
  std::uint64_t transits = 0;
  ExactSum virial;      ///< sum over collisions of impulse times distance of the centres
  ExactSum dissipated;  ///< energy lost in collisions
  ExactSum injected;    ///< energy gained in kicks (either sign per kick)

  [[nodiscard]] std::uint64_t collisions() const { return contacts[0] + contacts[1] + contacts[2]; }
};

/// A whole run at one moment: every event before `now` is done, none after it.
struct State {
  double box_length = 0;  ///< L of the periodic square
  Mixture mixture;
  CollisionLaw collision;
  Drive drive;
  std::uint64_t seed = 0;

  double epoch_length = 0;  ///< all records are advanced and re-based at multiples of this time
  std::uint64_t epoch = 0;  ///< epochs completed
  double now = 0;           ///< time since the start of the current epoch

  std::vector<Disk> disks;  ///< by id
  Tally tally;

  [[nodiscard]] std::size_t size() const { return disks.size(); }
  [[nodiscard]] double time() const { return static_cast<double>(epoch) * epoch_length + now; }
};

/// 16 hex digits over every field of every record, in order of id, and over the epoch, time, drive and tally.
std::string state_hash(const State& state);

/// Area fraction: sum of pi R^2 over the disks, divided by L^2.
double packing_fraction(const State& state);

/// Side of the square in which `small_count` + `big_count` disks have area fraction `packing_fraction`.
double box_length_for(const Mixture& mixture, std::size_t small_count, std::size_t big_count, double packing_fraction);

/// The smallest box an exact run allows: L >= 8 R_b, so that nearest images stay nearest between transits.
double minimum_box_length(const Mixture& mixture);

/// Kinetic temperature in 2D, T = <m v^2>/2, from velocities relative to the centre of mass; by species and for all.
struct Temperatures {
  double all = 0, small = 0, big = 0;
};
Temperatures temperatures(const State& state);

/// Kinetic energy of all disks, that of the centre of mass included.
double kinetic_energy(const State& state);

/// Total momentum [x, y].
std::array<double, 2> total_momentum(const State& state);

/// Gives every disk a Gaussian velocity of temperature T (component variance T/m), removes the total momentum and
/// scales so that T is exactly `temperature`. Draws from the stream `velocities` of `state.seed`.
void draw_velocities(State& state, double temperature);

/// Rate at which each disk's own kick clock rings: f/2 where a kick serves a pair, f for single kicks, 0 without drive.
double clock_rate(const Drive& drive);

/// Starts every disk's kick clock at `state.now` for the drive set in the state (or stops it where there is none).
void start_kick_clocks(State& state);

/// Changes frequency and amplitude of the drive of a running state; waiting times are stretched, which is exact for
/// Poisson clocks.
void change_drive(State& state, double frequency, double amplitude);

}  // namespace sandglass
