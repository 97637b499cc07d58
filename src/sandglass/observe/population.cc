#include "sandglass/observe/population.h"

namespace sandglass {

std::string group_name(Group group) {
  constexpr std::array<const char*, 3> names{"all", "small", "big"};
  return names[static_cast<std::size_t>(group)];
}

Population population_of(const State& state) {
  Population population;
  population.box_length = state.box_length;
  population.mixture = state.mixture;
  population.order.reserve(state.size());
  for (const Species species : {small, big}) {
    for (std::size_t id = 0; id < state.size(); ++id) {
      if (state.disks[id].species == species) population.order.push_back(static_cast<std::uint32_t>(id));
    }
    if (species == small) population.small_count = population.order.size();
  }
  return population;
}

namespace {

// Sorts one component and subtracts its mass-weighted mean.
void take_component(const std::vector<double>& by_id, const Population& population, std::vector<double>& sorted) {
  sorted.resize(population.size());
  // Most often the ids of a species are in a row: nothing is to be sorted.
  auto values_of = [&](Range range) -> const double* {
    if (range.size() == 0) return nullptr;
    const std::uint32_t first = population.order[range.begin], last = population.order[range.end - 1];
    if (last - first == range.size() - 1) return &by_id[first];
    for (std::size_t i = range.begin; i < range.end; ++i) sorted[i] = by_id[population.order[i]];
    return &sorted[range.begin];
  };
  const double* values[species_count];
  double moment = 0, mass = 0;
  for (const Species species : {small, big}) {
    const Range range = population.range(species);
    values[species] = values_of(range);
    const double m = population.mixture.mass[species];
    moment += m * ordered_sum({values[species], range.size()});
    mass += m * static_cast<double>(range.size());
  }
  const double mean = moment / mass;
  for (const Species species : {small, big}) {
    const Range range = population.range(species);
    for (std::size_t i = 0; i < range.size(); ++i) sorted[range.begin + i] = values[species][i] - mean;
  }
}

}  // namespace

void take_snapshot(const Frame& frame, const Population& population, Snapshot& snapshot) {
  take_component(frame.x, population, snapshot.x);
  take_component(frame.y, population, snapshot.y);
  take_velocities(frame, population, snapshot);
}

void take_velocities(const Frame& frame, const Population& population, Snapshot& snapshot) {
  take_component(frame.vx, population, snapshot.vx);
  take_component(frame.vy, population, snapshot.vy);
}

Temperatures temperatures(const Snapshot& snapshot, const Population& population) {
  std::array<double, species_count> energy{};
  std::vector<double> squares(snapshot.vx.size());
  for (std::size_t i = 0; i < squares.size(); ++i)
    squares[i] = snapshot.vx[i] * snapshot.vx[i] + snapshot.vy[i] * snapshot.vy[i];
  for (const Species species : {small, big}) {
    const Range range = population.range(species);
    energy[species] =
        0.5 * population.mixture.mass[species] * ordered_sum({squares.data() + range.begin, range.size()});
  }
  auto mean = [](double sum, std::size_t n) { return n ? sum / static_cast<double>(n) : 0.0; };
  return {mean(energy[small] + energy[big], population.size()), mean(energy[small], population.range(small).size()),
          mean(energy[big], population.range(big).size())};
}

}  // namespace sandglass
