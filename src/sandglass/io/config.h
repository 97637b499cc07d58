// The configuration of one run: a validated plain struct, read from TOML by one table of keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sandglass/core/state.h"
#include "sandglass/dynamics/vigilance.h"

namespace sandglass {

enum class PrepareMethod : std::uint8_t { quench, insert, file };

struct Config {
  struct System {
    std::uint64_t particles = 10000;
    double packing_fraction = 0.8;
    double size_ratio = 1.43;   ///< R_b / R_s
    double big_fraction = 0.5;  ///< fraction of the disks that are big
  } system;
  struct Collision {
    double restitution = 0.9;
    CollapsePolicy collapse_policy = CollapsePolicy::tc;
    double collapse_time = 2e-6;  ///< t_c in mean free times, by the formula
  } collision;
  struct DriveKeys {
    DriveKind kind = DriveKind::pair;
    PartnerRule partner = PartnerRule::nearest;
    double reach = 2;                 ///< in contact distances
    std::optional<double> frequency;  ///< f_Dr per disk and time; none: "collision", the measured collision rate
    double temperature = 1;
  } drive;
  struct Prepare {
    PrepareMethod method = PrepareMethod::quench;
    double jammed_fraction = 0.84;
    std::string file;
  } prepare;
  struct Run {
    std::uint64_t seed = 1;
    double equilibrate = 1000;  ///< collisions per disk before measuring
    double collisions = 10000;  ///< collisions per disk measured
    std::uint64_t intervals = 10;
    std::uint64_t threads = 1;
    double max_walltime_seconds = 0;  ///< 0: no limit
    Vigilance self_check = Vigilance::sampled;
  } run;
  struct Observe {
    std::vector<double> wavenumbers{0.5, 3.0};  ///< in 1 / R_s
    double lags_per_decade = 12;
    double overlap_length = 0.6;                 ///< in R_s
    double selection_time = 0;                   ///< 0: the length of an interval
    double exponent_from = 1, exponent_to = 10;  ///< times between which the exponent of the MSD is fitted
    std::optional<double> structure_frames;      ///< none: "auto", as many as cost little
    double bin_width = 0;                        ///< of g(r), in R_s; 0: L / 800, at most 0.4
  } observe;
  struct Output {
    std::uint64_t trajectory_frames = 11;
    double checkpoint_seconds = 300;
  } output;
};

/// Reads a TOML file (empty path: all defaults), then the assignments "key=value" of the command line in their order;
/// checks everything. Throws InputError naming file, line, key, the reason and the remedy; unknown keys get the nearest
/// known one suggested.
Config read_config(const std::filesystem::path& file, const std::vector<std::string>& assignments = {});

/// The same from text that is already in memory; `name` stands for the file in messages, and relative paths in it are
/// relative to `folder`.
Config read_config_text(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                        const std::vector<std::string>& assignments = {});

/// What no single key can tell: the method reaches the packing fraction, the drive makes a steady state, the box is
/// large enough, the species fill up the disks, the start file exists. Throws InputError. (Readers call it.)
void check_config(const Config& config);

/// The complete configuration as TOML, every default visible, one comment per key. Reading it gives the same Config.
std::string config_to_toml(const Config& config);

/// Reference documentation of all keys as a Markdown table: key, type, default, range, unit, meaning.
std::string config_reference();

/// The physics keys in which two configurations differ ("run.seed", ...), for --resume: only threads, checkpoint and
/// wall-time settings may differ.
std::vector<std::string> differing_keys(const Config& a, const Config& b);

}  // namespace sandglass
