#include "sandglass/report/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "sandglass/core/errors.h"
#include "sandglass/io/config_table.h"
#include "sandglass/report/number.h"

namespace sandglass {
namespace {

/// The standard error that the summary gives for a quantity; NaN when it gives none.
double error_of(const Summary& summary, std::string_view name) {
  for (const auto& [known, error] : summary.errors) {
    if (known == name) return error;
  }
  return Summary::unknown;
}

std::string measured(const Summary& summary, double value, std::string_view name) {
  return with_error(value, error_of(summary, name));
}

/// T_s / T_b. The two temperatures come from the same frames and their errors are correlated: the sum of the relative
/// errors holds in any case.
std::string temperature_ratio(const Summary& summary) {
  const auto& t = summary.temperature;
  const double ratio = t.small / t.big;
  const double relative =
      error_of(summary, "temperature_small") / t.small + error_of(summary, "temperature_big") / t.big;
  return with_error(ratio, ratio * relative);
}

std::string exponent_text(const Summary::Exponent& exponent) { return with_error(exponent.value, exponent.error); }

/// The last measured point of S_inc for the largest wavenumber: small disks, or all.
struct LastScattering {
  double wavenumber = Summary::unknown, time = Summary::unknown, value = Summary::unknown;
  double error = Summary::unknown;
};

LastScattering last_scattering(const std::vector<Figure>& figures) {
  LastScattering last;
  for (const Figure& figure : figures) {
    if (!figure.parameter || figure.curves.empty() || figure.curves.front().y.empty()) continue;
    if (last.wavenumber > *figure.parameter) continue;
    const Curve& curve = figure.curves.front();
    last = {*figure.parameter, curve.x.back(), curve.y.back(),
            curve.error.empty() ? Summary::unknown : curve.error.back()};
  }
  return last;
}

std::string describe_system(const Summary& summary, const std::optional<Config>& config) {
  std::string text = fmt::format("{} hard disks in a periodic square fill {:.4g} % of the area",
                                 grouped(summary.particles), 100 * summary.packing_fraction);
  if (config && config->system.size_ratio != 1)
    text += fmt::format("; {:.3g} % of them are {:g} times as large as the others", 100 * config->system.big_fraction,
                        config->system.size_ratio);
  text += summary.restitution < 1
              ? fmt::format(". Every collision costs energy (restitution {:g})", summary.restitution)
              : std::string(". Collisions are elastic");
  if (config) {
    switch (config->drive.kind) {
      case DriveKind::pair:
        text += ", and kicks on pairs of neighbours, with opposite momenta, bring it back";
        break;
      case DriveKind::single:
        text += ", and kicks on single disks bring it back";
        break;
      case DriveKind::none:
        text += ", and nothing drives the disks";
        break;
    }
  }
  return text + fmt::format(
                    ". They were measured for {} collisions per disk (a time of {}), at {} collisions per disk "
                    "and unit of time and a temperature of {}.",
                    short_number(summary.collisions_per_particle), short_number(summary.time),
                    measured(summary, summary.collision_rate, "collision_rate"),
                    measured(summary, summary.temperature.all, "temperature_all"));
}

std::string describe_relaxation(const Summary& summary, const LastScattering& last) {
  std::string text;
  const Summary::Exponent& exponent = summary.msd_exponent.small;
  if (std::isfinite(exponent.value)) {
    const char* meaning = exponent.value < 0.9
                              ? "slower than diffusion (exponent 1): neighbours hold the disks in cages"
                          : exponent.value <= 1.1 ? "as in ordinary diffusion (exponent 1)"
                                                  : "faster than diffusion (exponent 1), on the way from free flight "
                                                    "(exponent 2)";
    text += fmt::format(
        "Between t = {:g} and {:.3g} the mean square displacement of the small disks grows as t to the power "
        "{}, {}. ",
        exponent.from, std::fmin(exponent.to, last.time), exponent_text(exponent), meaning);
  }
  if (std::isfinite(last.value)) {
    const char* meaning = last.value > 0.5   ? "most of the structure is still there: the system has not relaxed"
                          : last.value > 0.1 ? "the structure is on its way to being forgotten"
                                             : "the structure is forgotten: the system has relaxed";
    text += fmt::format("After t = {}, S_inc of the small disks at k = {:.3g} has come down from 1 to {}; {}.",
                        short_number(last.time), last.wavenumber, with_error(last.value, last.error), meaning);
  }
  return text;
}

std::string describe_state(const Summary& summary) {
  std::string text;
  const auto& t = summary.temperature;
  if (std::isfinite(t.small / t.big))
    text += fmt::format(
        "The temperature of the small disks over that of the big ones is T_s/T_b = {}; in equilibrium it "
        "would be 1. ",
        temperature_ratio(summary));
  text += summary.stationary
              ? "Over the measured stretch the run passed the test of stationarity."
              : "The run did not pass the test of stationarity: what is averaged here may change with the age of the "
                "system.";
  return text;
}

Table results_table(const Summary& s) {
  Table table{{"Quantity", "Value", "Unit", "Meaning"}, {}};
  auto row = [&](const char* name, std::string value, const char* unit, const char* meaning) {
    table.rows.push_back({name, std::move(value), unit, meaning});
  };
  const auto value = [&](double number, std::string_view error) { return measured(s, number, error); };
  constexpr const char* energy = "T₀";
  constexpr const char* time = "Rₛ √(mₛ/T₀)";
  constexpr const char* rate = "√(T₀/mₛ) / Rₛ";
  row("T", value(s.temperature.all, "temperature_all"), energy, "granular temperature: mean kinetic energy per disk");
  row("T_s", value(s.temperature.small, "temperature_small"), energy, "of the small disks");
  row("T_b", value(s.temperature.big, "temperature_big"), energy, "of the big disks");
  row("T_s / T_b", temperature_ratio(s), "", "1 in equilibrium");
  row("temperature drift", short_number(s.temperature_drift), "", "relative change of T over the measured stretch");
  row("ω", value(s.collision_rate, "collision_rate"), rate, "collisions per disk; each counts for both partners");
  row("Z", value(s.compressibility_factor, "compressibility_factor"), "", "compressibility factor p V / (N T)");
  row("MSD exponent, small", exponent_text(s.msd_exponent.small), "", "between the times named in the figure");
  row("MSD exponent, big", exponent_text(s.msd_exponent.big), "", "the same for the big disks");
  row("t(MSD = 1), small", value(s.msd_unit_time.small, "msd_unit_time_small"), time,
      "when the mean square displacement reaches Rₛ²; unknown: not in this run");
  row("t(MSD = 1), big", value(s.msd_unit_time.big, "msd_unit_time_big"), time, "the same for the big disks");
  row("p_Dr", short_number(s.kick_amplitude), "√(mₛ T₀)", "standard deviation of a component of a kick");
  row("f_Dr", short_number(s.kick_frequency), rate, "rate at which a disk is kicked, as set");
  row("kick rate, small", short_number(s.kick_rate.small), rate, "as it came out, first or second of a pair");
  row("kick rate, big", short_number(s.kick_rate.big), rate, "the same for the big disks");
  row("kicks", grouped(s.kicks), "", "kick events that acted");
  row("kicks without partner", grouped(s.kicks_without_partner), "", "skipped because nobody was in reach");
  row("elastic collisions", short_number(s.elastic_collision_fraction), "",
      "fraction made elastic against the collapse");
  row("energy injected", short_number(s.energy.injected), "T₀ per disk", "by kicks, over the measured stretch");
  row("energy dissipated", short_number(s.energy.dissipated), "T₀ per disk",
      "in collisions, over the measured stretch");
  row("energy balance", short_number(s.energy.balance), "", "injected minus dissipated minus stored, over injected");
  row("momentum", fmt::format("{}, {}", short_number(s.momentum[0]), short_number(s.momentum[1])), "√(mₛ T₀)",
      "total x and y at the end");
  row("box length", short_number(s.box_length), "Rₛ", "side L of the periodic square");
  row("collisions", grouped(s.collisions), "", "measured, in all");
  row("collisions per disk", short_number(s.collisions_per_particle), "", "s = 2 collisions / N");
  row("time", short_number(s.time), time, "of the measured stretch");
  row("wall time", short_number(s.wall_seconds), "s", "that the run took");
  row("speed", short_number(s.collisions_per_second), "collisions / s", "of the simulation");
  return table;
}

Table parameters_table(const Config& config) {
  Table table{{"Key", "Value", "Unit", "Meaning"}, {}};
  for (const Key& key : config_table())
    table.rows.push_back(
        {std::string(key.name), key.write(config, key), std::string(key.unit), std::string(key.description)});
  return table;
}

std::vector<std::pair<std::string, std::string>> highlights(const Summary& s, const LastScattering& last) {
  std::vector<std::pair<std::string, std::string>> list{
      {"temperature T", measured(s, s.temperature.all, "temperature_all")},
      {"T_s / T_b", temperature_ratio(s)},
      {"collisions per disk and time", measured(s, s.collision_rate, "collision_rate")},
      {"MSD exponent, small disks", exponent_text(s.msd_exponent.small)}};
  if (std::isfinite(last.value))
    list.emplace_back(fmt::format("S_inc(k = {:.3g}) at t = {}", last.wavenumber, short_number(last.time)),
                      with_error(last.value, last.error));
  list.emplace_back("compressibility factor Z", measured(s, s.compressibility_factor, "compressibility_factor"));
  list.emplace_back("stationary", s.stationary ? "yes" : "not shown");
  return list;
}

/// Rows whose numbers, where unknown, are no less printed: counts and the like that only a run has.
bool of_a_run(std::string_view row) {
  return row == "kicks" || row == "kicks without partner" || row == "momentum" || row == "collisions" ||
         row == "wall time" || row == "speed";
}

/// What was measured on stored frames, in a sentence.
std::string describe_frames(const Summary& summary) {
  std::string text = fmt::format("{} disks in a periodic square fill {:.4g} % of the area", grouped(summary.particles),
                                 100 * summary.packing_fraction);
  if (std::isfinite(summary.time))
    text += fmt::format(". Stored frames were measured over a time of {}", short_number(summary.time));
  if (std::isfinite(summary.temperature.all))
    text += fmt::format(", at a temperature of {}", measured(summary, summary.temperature.all, "temperature_all"));
  return text + ".";
}

/// Figures, numbers, remarks: what the page of a run and that of an analysis have in common.
Page page_of_measurements(const RunRecord& record) {
  Page page;
  page.figures = run_figures(record.results, record.summary);
  if (!record.results_missing.empty()) {
    for (Figure& figure : page.figures) figure.missing = record.results_missing;
  }
  page.packing = record.packing;
  page.packing_missing = record.packing_missing;
  page.results = results_table(record.summary);
  page.decisions = record.summary.decisions;
  page.warnings = record.summary.warnings;
  page.commands = {record.command};
  return page;
}

void add_texts(Page& page, std::initializer_list<std::string> texts) {
  for (const std::string& text : texts)
    if (!text.empty()) page.summary.push_back(text);
}

}  // namespace

Page run_page(const RunRecord& run) {
  const Summary& summary = run.summary;
  Page page = page_of_measurements(run);
  std::optional<Config> config;
  try {
    config = read_config_text(run.config_toml, "config.toml", ".");
    page.parameters = parameters_table(*config);
  } catch (const InputError& error) {
    page.parameters = {{"The configuration is given below as text only"}, {{error.what()}}};
  }
  page.title = fmt::format("Granular fluid at packing fraction {:g}, restitution {:g}", summary.packing_fraction,
                           summary.restitution);
  page.subtitle = fmt::format("{} hard disks · {} collisions per disk · seed {}", grouped(summary.particles),
                              short_number(summary.collisions_per_particle), summary.seed);
  const LastScattering last = last_scattering(page.figures);
  add_texts(page, {describe_system(summary, config), describe_relaxation(summary, last), describe_state(summary)});
  page.highlights = highlights(summary, last);
  page.decisions.push_back(
      "Errors are standard errors over the intervals into which the measured stretch was cut. They are right where an "
      "interval is longer than the relaxation time; where it is not, only independent starts tell the error.");
  page.config = run.config_toml;
  page.provenance = {
      {"version", summary.version}, {"seed", std::to_string(summary.seed)}, {"state hash", summary.state_hash}};
  return page;
}

Page analysis_page(const RunRecord& analysis) {
  const Summary& summary = analysis.summary;
  Page page = page_of_measurements(analysis);
  page.title = fmt::format("Stored frames at packing fraction {:.4g}", summary.packing_fraction);
  page.subtitle = fmt::format("{} disks · measured by sandglass analyze", grouped(summary.particles));
  const LastScattering last = last_scattering(page.figures);
  add_texts(page, {describe_frames(summary), describe_relaxation(summary, last)});
  page.highlights = highlights(summary, last);
  std::erase_if(page.highlights,
                [](const auto& entry) { return entry.second == "unknown" || entry.first == "stationary"; });
  std::erase_if(page.results.rows, [](const auto& row) { return row[1] == "unknown" || of_a_run(row[0]); });
  page.decisions.push_back(
      "Errors are standard errors over the blocks into which the frames were cut. They are right where a block is "
      "longer than the relaxation time.");
  page.provenance = {{"version", summary.version}};
  return page;
}

}  // namespace sandglass
