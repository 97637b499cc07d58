#include "sandglass/observe/tally_averages.h"

#include <functional>

#include "sandglass/core/errors.h"

namespace sandglass {
namespace {

double difference(const ExactSum& begin, const ExactSum& end) {
  ExactSum sum = end;
  sum.subtract(begin);
  return sum.value();
}

}  // namespace

IntervalFlows interval_flows(std::span<const Tally> boundaries, double interval_length,
                             std::span<const double> temperatures, std::size_t disks) {
  const auto n = static_cast<double>(disks);
  IntervalFlows flows;
  for (std::size_t i = 0; i + 1 < boundaries.size() && i < temperatures.size(); ++i) {
    const Tally &begin = boundaries[i], &end = boundaries[i + 1];
    const double excess =
        difference(begin.virial, end.virial) / (2 * temperatures[i]) * (n - 1) / n / (n * interval_length);
    flows.compressibility_factor.push_back(1 + excess);
    flows.injected.push_back(difference(begin.injected, end.injected) / (n * interval_length));
    flows.dissipated.push_back(difference(begin.dissipated, end.dissipated) / (n * interval_length));
  }
  return flows;
}

TallyAverages tally_averages(std::span<const Tally> boundaries, double interval_length,
                             std::span<const double> temperatures, std::array<std::size_t, species_count> disks) {
  if (boundaries.size() < 2 || temperatures.size() + 1 != boundaries.size())
    throw RunError("Averages need the tally at both ends of every interval; measure at least one whole interval.");
  // Mean and error of a rate: what `amount` says happened in each interval, over its length and `share` disks.
  auto rate = [&](double share, const std::function<double(std::size_t)>& amount) {
    std::vector<double> values;
    for (std::size_t i = 0; i + 1 < boundaries.size(); ++i) values.push_back(amount(i) / (share * interval_length));
    return share > 0 ? mean_of_intervals(values) : Estimate{};
  };
  auto counted = [&](std::size_t i, auto&& count) {
    return static_cast<double>(count(boundaries[i + 1]) - count(boundaries[i]));
  };
  const auto n = static_cast<double>(disks[small] + disks[big]);

  TallyAverages averages;
  averages.collision_rate =
      rate(n, [&](std::size_t i) { return 2 * counted(i, [](const Tally& t) { return t.collisions(); }); });
  for (const Species a : {small, big}) {
    for (const Species b : {small, big}) {
      const double per_contact = a == b ? 2 : 1;
      averages.partner_rate[a][b] = rate(static_cast<double>(disks[a]), [&](std::size_t i) {
        return per_contact * counted(i, [&](const Tally& t) { return t.contacts[static_cast<std::size_t>(a + b)]; });
      });
    }
    averages.kick_rate[a] = rate(static_cast<double>(disks[a]), [&](std::size_t i) {
      return counted(i, [&](const Tally& t) { return t.kicked[a]; });
    });
  }
  const IntervalFlows flows = interval_flows(boundaries, interval_length, temperatures, disks[small] + disks[big]);
  averages.injected = mean_of_intervals(flows.injected);
  averages.dissipated = mean_of_intervals(flows.dissipated);
  averages.compressibility_factor = mean_of_intervals(flows.compressibility_factor);

  const std::uint64_t collisions = boundaries.back().collisions() - boundaries.front().collisions();
  const std::uint64_t elastic = boundaries.back().elastic_contacts - boundaries.front().elastic_contacts;
  averages.elastic_fraction = collisions ? static_cast<double>(elastic) / static_cast<double>(collisions) : 0;
  return averages;
}

}  // namespace sandglass
