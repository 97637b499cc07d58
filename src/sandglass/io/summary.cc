#include "sandglass/io/summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <type_traits>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"

namespace sandglass {
namespace {

using Json = nlohmann::ordered_json;

template <class Exponent, class Visit>
void visit_exponent(const std::string& at, Exponent& exponent, Visit&& visit) {
  visit(at + "/value", exponent.value);
  visit(at + "/error", exponent.error);
  visit(at + "/from", exponent.from);
  visit(at + "/to", exponent.to);
}

/// The one list of members with their places in the file; writing and reading walk it.
template <class S, class Visit>
void visit_members(S& s, Visit&& visit) {
  visit("/version", s.version);
  visit("/seed", s.seed);
  visit("/particles", s.particles);
  visit("/packing_fraction", s.packing_fraction);
  visit("/restitution", s.restitution);
  visit("/box_length", s.box_length);
  visit("/time", s.time);
  visit("/collisions", s.collisions);
  visit("/collisions_per_particle", s.collisions_per_particle);
  visit("/temperature/all", s.temperature.all);
  visit("/temperature/small", s.temperature.small);
  visit("/temperature/big", s.temperature.big);
  visit("/temperature_drift", s.temperature_drift);
  visit("/collision_rate", s.collision_rate);
  visit("/compressibility_factor", s.compressibility_factor);
  visit("/kick_amplitude", s.kick_amplitude);
  visit("/kick_frequency", s.kick_frequency);
  visit("/kicks", s.kicks);
  visit("/kicks_without_partner", s.kicks_without_partner);
  visit("/kick_rate/small", s.kick_rate.small);
  visit("/kick_rate/big", s.kick_rate.big);
  visit("/calibration/kick_amplitude", s.calibration.kick_amplitude);
  visit("/calibration/kick_frequency", s.calibration.kick_frequency);
  visit("/calibration/windows", s.calibration.windows);
  visit("/calibration/temperature_error", s.calibration.temperature_error);
  visit("/elastic_collision_fraction", s.elastic_collision_fraction);
  visit("/energy/injected", s.energy.injected);
  visit("/energy/dissipated", s.energy.dissipated);
  visit("/energy/balance", s.energy.balance);
  visit("/momentum", s.momentum);
  visit("/stationary", s.stationary);
  visit_exponent("/msd_exponent/small", s.msd_exponent.small, visit);
  visit_exponent("/msd_exponent/big", s.msd_exponent.big, visit);
  visit("/msd_unit_time/small", s.msd_unit_time.small);
  visit("/msd_unit_time/big", s.msd_unit_time.big);
  visit("/errors", s.errors);
  visit("/decisions", s.decisions);
  visit("/warnings", s.warnings);
  visit("/wall_seconds", s.wall_seconds);
  visit("/collisions_per_second", s.collisions_per_second);
  visit("/state_hash", s.state_hash);
}

using Errors = std::vector<std::pair<std::string, double>>;

template <class T>
Json pack(const T& value) {
  if constexpr (std::is_same_v<T, Errors>) {
    Json object = Json::object();
    for (const auto& [name, error] : value) object[name] = error;
    return object;
  } else {
    return value;  // NaN and infinities are printed as null
  }
}

double number_or_unknown(const Json& json) { return json.is_null() ? Summary::unknown : json.get<double>(); }

template <class T>
void unpack(const Json& json, T& value) {
  if constexpr (std::is_same_v<T, double>) {
    value = number_or_unknown(json);
  } else if constexpr (std::is_same_v<T, std::array<double, 2>>) {
    value = {number_or_unknown(json.at(0)), number_or_unknown(json.at(1))};
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    // The library would convert any number, whatever becomes of it.
    if (!json.is_number_unsigned()) throw InputError(fmt::format("{} is not a count", json.dump()));
    value = json.get<T>();
  } else if constexpr (std::is_same_v<T, Errors>) {
    if (!json.is_object()) throw InputError("the errors are not listed by name");
    for (const auto& [name, error] : json.items()) value.emplace_back(name, number_or_unknown(error));
  } else {
    value = json.get<T>();
  }
}

}  // namespace

std::string to_json(const Summary& summary) {
  Json json;
  visit_members(summary, [&](const std::string& at, const auto& value) { json[Json::json_pointer(at)] = pack(value); });
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Summary summary_from_json(const std::string& text) {
  Summary summary;
  try {
    const Json json = Json::parse(text);
    // Members that were added later may be missing, but not this one.
    if (!json.contains("state_hash")) throw InputError("this is not the summary of a run: it has no state_hash");
    visit_members(summary, [&](const std::string& at, auto& value) {
      const Json::json_pointer place(at);
      if (json.contains(place)) unpack(json.at(place), value);
    });
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("this is not the summary of a run: {}", error.what()));
  }
  return summary;
}

void write_summary(const std::filesystem::path& path, const Summary& summary) { write_whole(path, to_json(summary)); }

Summary read_summary(const std::filesystem::path& path) {
  constexpr std::size_t longest = 1 << 24;
  try {
    return summary_from_json(read_whole(path, longest));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace sandglass
