#include "sandglass/study/summarise.h"

#include <fmt/format.h>

#include <cmath>

#include "sandglass/core/version.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/observe/fit.h"
#include "sandglass/observe/stationarity.h"

namespace sandglass {
namespace {

void describe_motion(const Correlator& correlator, std::array<double, 2> exponent_range, Summary& summary) {
  const double from = exponent_range[0], to = exponent_range[1];
  const auto fill = [&](Group group, Summary::Exponent& exponent, double& unit_time, const std::string& name) {
    const IntervalSeries series = correlator.mean_square_displacement(group);
    const Estimate fit = power_law_exponent(series, from, to);
    exponent = {fit.value, fit.error, from, to};
    const Estimate passage = passage_time(series, 1);
    unit_time = passage.value;
    summary.errors.emplace_back("msd_unit_time_" + name, passage.error);
  };
  fill(Group::small, summary.msd_exponent.small, summary.msd_unit_time.small, "small");
  fill(Group::big, summary.msd_exponent.big, summary.msd_unit_time.big, "big");
}

/// D per collision at s = 1000 [the paper's], or at the longest lag where that is shorter.
Summary::Diffusion diffusion_of(const Correlator& correlator, Group group) {
  constexpr double paper_collisions = 1000;
  const double rate = correlator.collision_rate();
  const IntervalSeries displacements = correlator.mean_square_displacement(group);
  const double time = std::fmin(paper_collisions / rate, displacements.time.back());
  const Estimate slope = diffusion_coefficient(displacements, time);
  const Estimate integral = value_at(correlator.running_diffusion(group), time);
  return {slope.value / rate, slope.error / rate, time * rate, integral.value / rate, integral.error / rate};
}

void describe_relaxation(const Correlator& correlator, Summary& summary) {
  summary.diffusion = {diffusion_of(correlator, Group::small), diffusion_of(correlator, Group::big),
                       diffusion_of(correlator, Group::all)};
  constexpr double level = 0.5;
  const std::vector<double>& wavenumbers = correlator.plan().wavenumbers;
  for (std::size_t k = 0; k < wavenumbers.size(); ++k) {
    const Estimate small_disks = decay_time(correlator.self_intermediate_scattering(Group::small, k), level);
    const Estimate big_disks = decay_time(correlator.self_intermediate_scattering(Group::big, k), level);
    summary.relaxation_time.push_back(
        {wavenumbers[k], small_disks.value, small_disks.error, big_disks.value, big_disks.error});
  }
}

void describe_structure(const StructureSampler& structure, Summary& summary) {
  const auto note = [&](double& target, const std::string& name, const Estimate& estimate) {
    target = estimate.value;
    summary.errors.emplace_back(name, estimate.error);
  };
  note(summary.contact_value.small_small, "contact_value_small_small", structure.contact_value(0));
  note(summary.contact_value.small_big, "contact_value_small_big", structure.contact_value(1));
  note(summary.contact_value.big_big, "contact_value_big_big", structure.contact_value(2));
  note(summary.bond_order.global, "bond_order_global", structure.global_bond_order());
  note(summary.bond_order.local, "bond_order_local", structure.local_bond_order());
  note(summary.velocity_correlation_length, "velocity_correlation_length", structure.velocity_correlation_length());
  summary.anisotropy = {structure.anisotropy(Group::all), structure.anisotropy(Group::small)};
}

void describe_partners(const TallyAverages& averages, Summary& summary) {
  const auto note = [&](double& target, const char* name, Species a, Species b) {
    target = averages.partner_rate[a][b].value;
    summary.errors.emplace_back(std::string("collision_rate_") + name, averages.partner_rate[a][b].error);
  };
  note(summary.collision_rate_by_pair.small_small, "small_small", small, small);
  note(summary.collision_rate_by_pair.small_big, "small_big", small, big);
  note(summary.collision_rate_by_pair.big_small, "big_small", big, small);
  note(summary.collision_rate_by_pair.big_big, "big_big", big, big);
}

void describe_energy(const State& end, const TallyAverages& averages, const RunFacts& facts, Summary& summary) {
  const double disks = static_cast<double>(end.size());
  summary.energy.injected = averages.injected.value * summary.time;
  summary.energy.dissipated = averages.dissipated.value * summary.time;
  summary.errors.emplace_back("energy_injected", averages.injected.error * summary.time);
  summary.errors.emplace_back("energy_dissipated", averages.dissipated.error * summary.time);
  const double change = (facts.end_energy - facts.start_energy) / disks;
  const double turnover = std::fmax(std::fabs(summary.energy.injected), std::fabs(summary.energy.dissipated));
  const double imbalance = summary.energy.injected - summary.energy.dissipated - change;
  summary.energy.balance = turnover > 0 ? imbalance / turnover : imbalance;
}

void describe_drive(const Config& config, const State& end, const RunFacts& facts, Summary& summary) {
  auto decided = [&](std::string sentence) { summary.decisions.push_back(std::move(sentence)); };
  if (config.drive.kind == DriveKind::none) {
    decided(config.collision.restitution < 1
                ? "Nothing drives the disks: they cool. Lengths of the run (equilibrate, collisions) were counted in "
                  "mean free times at the initial temperature, by the formula."
                : "Nothing drives the disks; they collide elastically and keep their energy.");
    return;
  }
  const Calibration& c = facts.calibration;
  decided(fmt::format(
      "The drive was calibrated on a copy of the start and then frozen: {:.6g} kicks per disk and time ({}), kick "
      "amplitude p_Dr = {:.6g}, from {} windows, by whose scatter T should come out right to {:.2g} %.",
      end.drive.frequency, config.drive.frequency ? "as asked for" : "the collision rate of the steady state",
      end.drive.amplitude, c.windows, 100 * c.temperature_error));
  if (!c.converged)
    summary.warnings.push_back("The calibration of the drive did not settle: T may differ from drive.temperature.");
  if (end.tally.kicks_without_partner > 0)
    decided(fmt::format("{} of {} kicks were skipped because no disk was within reach = {} contact distances.",
                        end.tally.kicks_without_partner, end.tally.kicks_without_partner + end.tally.kicks,
                        config.drive.reach));
}

void describe_collapse(const Config& config, const State& end, Summary& summary) {
  if (config.collision.collapse_policy == CollapsePolicy::tc && config.collision.restitution < 1) {
    summary.decisions.push_back(fmt::format(
        "A fraction {:.2g} of the collisions was made elastic, because one of the disks had collided less than t_c = "
        "{:.3g} before (TC model, against inelastic collapse).",
        summary.elastic_collision_fraction, end.collision.collapse_time));
    if (summary.elastic_collision_fraction > 1e-3)
      summary.warnings.push_back(
          "More than one collision in a thousand was made elastic: the dissipation is noticeably weaker than that of "
          "the restitution asked for. Lower collision.collapse_time.");
  }
}

void judge(const Config& config, const Measurement& measurement, Summary& summary) {
  const Stationarity verdict =
      judge_stationarity(measurement.averages().part_temperatures(), measurement.averages().part_collision_rates());
  summary.stationary = verdict.stationary;
  const Trend& temperature = verdict.temperature;
  summary.temperature_drift = temperature.mean > 0 ? temperature.drift / temperature.mean : Summary::unknown;
  if (!verdict.stationary && (config.drive.kind != DriveKind::none || config.collision.restitution == 1)) {
    const Trend& rate = verdict.collision_rate;
    summary.warnings.push_back(fmt::format(
        "The measured stretch was not stationary: T changed by {:+.2f} % and the collision rate by {:+.2f} % from its "
        "first to its last part. The system ages: averages and errors depend on the waiting time. Equilibrate "
        "longer (run.equilibrate), or take independent starts.",
        100 * temperature.drift / temperature.mean, 100 * rate.drift / rate.mean));
  }

  // Errors over intervals mean something only when an interval forgets the one before: when disks leave their cages.
  if (!(summary.msd_unit_time.small < measurement.plan().interval_length &&
        summary.msd_unit_time.big < measurement.plan().interval_length))
    summary.warnings.push_back(fmt::format(
        "An interval ({:.4g} time units) is shorter than the time in which disks move by their radius: intervals are "
        "not independent and standard errors over them are too small for long times. Use fewer, longer intervals or "
        "independent starts (other seeds).",
        measurement.plan().interval_length));
}

}  // namespace

std::string fewer_threads(const Config& config, unsigned used) {
  const std::string asked = fmt::format("{} of {} threads worked on the trajectory", used, config.run.threads);
  if (threads_for(config.system.particles, config.run.threads) == 1)
    return fmt::format(
        "{}: with fewer than {} disks more would be slower. Runs with other seeds side by side make better use of the "
        "cores.",
        asked, least_disks_for_threads);
  if (config.drive.kind == DriveKind::pair && config.drive.partner == PartnerRule::within)
    return fmt::format("{}: kicks of partners within reach are done on one (drive.partner = nearest on several).",
                       asked);
  return fmt::format("{}: at this size and density more would not pay.", asked);
}

void summarise_frames(const Correlator& correlator, const StructureSampler& structure,
                      std::array<double, 2> exponent_range, Summary& summary) {
  describe_motion(correlator, exponent_range, summary);
  describe_relaxation(correlator, summary);
  describe_structure(structure, summary);
}

Summary summarise(const Config& config, const State& end, const Measurement& measurement, const RunFacts& facts) {
  const TallyAverages averages = measurement.tally_averages();
  const IntervalAverages& intervals = measurement.averages();
  const Tally &first = measurement.boundaries().front(), &last = measurement.boundaries().back();

  Summary summary;
  summary.version = version;
  summary.seed = end.seed;
  summary.particles = end.size();
  summary.packing_fraction = config.system.packing_fraction;  // that of the state to rounding
  summary.restitution = end.collision.restitution;
  summary.box_length = end.box_length;
  summary.time = measurement.plan().end() - measurement.plan().start;
  summary.collisions = last.collisions() - first.collisions();
  summary.collisions_per_particle = 2.0 * static_cast<double>(summary.collisions) / static_cast<double>(end.size());
  const Estimate all = intervals.temperature(Group::all), small_disks = intervals.temperature(Group::small),
                 big_disks = intervals.temperature(Group::big);
  summary.temperature = {all.value, small_disks.value, big_disks.value};
  summary.collision_rate = averages.collision_rate.value;
  summary.compressibility_factor = averages.compressibility_factor.value;
  summary.errors = {{"temperature_all", all.error},
                    {"temperature_small", small_disks.error},
                    {"temperature_big", big_disks.error},
                    {"collision_rate", averages.collision_rate.error},
                    {"compressibility_factor", averages.compressibility_factor.error}};
  summary.kick_amplitude = end.drive.amplitude;
  summary.kick_frequency = end.drive.frequency;
  summary.elastic_collision_fraction = averages.elastic_fraction;
  summary.momentum = total_momentum(end);
  summary.kicks = last.kicks - first.kicks;
  summary.kicks_without_partner = last.kicks_without_partner - first.kicks_without_partner;
  summary.kick_rate = {averages.kick_rate[small].value, averages.kick_rate[big].value};
  if (facts.calibration.windows > 0)
    summary.calibration = {facts.calibration.amplitude, facts.calibration.frequency, facts.calibration.windows,
                           facts.calibration.temperature_error};
  summary.wall_seconds = facts.wall_seconds;
  summary.collisions_per_second = facts.collisions_per_second;
  summary.state_hash = state_hash(end);

  if (facts.threads < config.run.threads) summary.decisions.push_back(fewer_threads(config, facts.threads));
  summarise_frames(measurement.correlator(), measurement.structure(),
                   {config.observe.exponent_from, config.observe.exponent_to}, summary);
  describe_partners(averages, summary);
  describe_energy(end, averages, facts, summary);
  describe_drive(config, end, facts, summary);
  describe_collapse(config, end, summary);
  judge(config, measurement, summary);
  return summary;
}

}  // namespace sandglass
