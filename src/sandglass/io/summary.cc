#include "sandglass/io/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>
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

template <class Diffusion, class Visit>
void visit_diffusion(const std::string& at, Diffusion& diffusion, Visit&& visit) {
  visit(at + "/from_msd", diffusion.from_msd);
  visit(at + "/error", diffusion.error);
  visit(at + "/at_collisions", diffusion.at_collisions);
  visit(at + "/from_vacf", diffusion.from_vacf);
  visit(at + "/vacf_error", diffusion.vacf_error);
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
  visit_diffusion("/diffusion/small", s.diffusion.small, visit);
  visit_diffusion("/diffusion/big", s.diffusion.big, visit);
  visit_diffusion("/diffusion/all", s.diffusion.all, visit);
  visit("/relaxation_time", s.relaxation_time);
  visit("/contact_value/small_small", s.contact_value.small_small);
  visit("/contact_value/small_big", s.contact_value.small_big);
  visit("/contact_value/big_big", s.contact_value.big_big);
  visit("/collision_rate_by_pair/small_small", s.collision_rate_by_pair.small_small);
  visit("/collision_rate_by_pair/small_big", s.collision_rate_by_pair.small_big);
  visit("/collision_rate_by_pair/big_small", s.collision_rate_by_pair.big_small);
  visit("/collision_rate_by_pair/big_big", s.collision_rate_by_pair.big_big);
  visit("/bond_order/global", s.bond_order.global);
  visit("/bond_order/local", s.bond_order.local);
  visit("/anisotropy/all", s.anisotropy.all);
  visit("/anisotropy/small", s.anisotropy.small);
  visit("/velocity_correlation_length", s.velocity_correlation_length);
  visit("/errors", s.errors);
  visit("/decisions", s.decisions);
  visit("/warnings", s.warnings);
  visit("/wall_seconds", s.wall_seconds);
  visit("/collisions_per_second", s.collisions_per_second);
  visit("/state_hash", s.state_hash);
}

using Errors = std::vector<std::pair<std::string, double>>;
using RelaxationTimes = std::vector<Summary::RelaxationTime>;

template <class T>
Json pack(const T& value) {
  if constexpr (std::is_same_v<T, Errors>) {
    Json object = Json::object();
    for (const auto& [name, error] : value) object[name] = error;
    return object;
  } else if constexpr (std::is_same_v<T, RelaxationTimes>) {
    Json object = Json::object();
    for (const auto& [k, small_disks, error, big_disks, big_error] : value)
      object[fmt::format("{}", k)] = {
          {"small", small_disks}, {"error", error}, {"big", big_disks}, {"big_error", big_error}};
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
  } else if constexpr (std::is_same_v<T, RelaxationTimes>) {
    for (const auto& entry : json.items()) {
      const auto member = [&](const char* key) { return number_or_unknown(entry.value().at(key)); };
      value.push_back({std::strtod(entry.key().c_str(), nullptr), member("small"), member("error"), member("big"),
                       member("big_error")});
    }
  } else {
    value = json.get<T>();
  }
}

/// What stored frames cannot tell.
bool needs_run(std::string_view place) {
  constexpr std::array<std::string_view, 13> places{
      "/seed",        "/restitution", "/collisions", "/compressibility_factor", "/kick", "/calibration", "/energy",
      "/elastic_col", "/momentum",    "/stationary", "/temperature_drift",      "/wall", "/state_hash"};
  if (place == "/collisions_per_particle") return false;
  if (place.starts_with("/collisions_per_second") || place.starts_with("/collision_rate_by_pair")) return true;
  return std::any_of(places.begin(), places.end(), [&](std::string_view start) { return place.starts_with(start); });
}

}  // namespace

std::string to_json(const Summary& summary) {
  Json json;
  visit_members(summary, [&](const std::string& at, const auto& value) {
    if (!summary.from_frames || !needs_run(at)) json[Json::json_pointer(at)] = pack(value);
  });
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
