#include "sandglass/observe/contact_rate.h"

#include <algorithm>
#include <cmath>

#include "sandglass/observe/cells.h"
#include "sandglass/observe/structure.h"

namespace sandglass {

ContactRate::ContactRate(const Population& population, double range)
    : box_length_(population.box_length),
      radius_{population.mixture.radius[small], population.mixture.radius[big]},
      range_(range),
      species_(species_by_id(population)) {}

void ContactRate::add(const Frame& frame) {
  const Cells cells(frame.x, frame.y, box_length_, 2 * std::max(radius_[small], radius_[big]) * (1 + range_));
  std::vector<Cells::Neighbour> near;
  std::array<Bins, 3> speeds{};
  for (std::uint32_t id = 0; id < frame.size(); ++id) {
    cells.collect(id, 1, near);
    for (const auto& other : near) {
      if (other.id < id) continue;
      const double contact = radius_[species_[id]] + radius_[species_[other.id]];
      const double distance = std::sqrt(other.squared()), gap = distance / contact - 1;
      const double place = gap / range_ * bins;
      if (!(place >= 0 && place < bins)) continue;
      const auto bin = static_cast<std::size_t>(place);
      const double vx = frame.vx[other.id] - frame.vx[id], vy = frame.vy[other.id] - frame.vy[id];
      const double passing = std::fabs(other.dx * vx + other.dy * vy) / (2 * distance * contact * range_ / bins);
      const std::size_t pair = species_[id] + species_[other.id];
      speeds[pair][bin] += passing;
      squares_[pair][bin] += passing * passing;
    }
  }
  for (std::size_t pair = 0; pair < 3; ++pair) {
    double estimate = 0;
    for (std::size_t bin = 0; bin < bins; ++bin) estimate += edge_weight(bin) * speeds[pair][bin];
    sum_[pair] += estimate;
    sum_of_squares_[pair] += estimate * estimate;
  }
  ++frames_;
}

Estimate ContactRate::collisions_per_time(std::size_t pair) const {
  const auto frames = static_cast<double>(frames_);
  double counting = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) counting += edge_weight(bin) * edge_weight(bin) * squares_[pair][bin];
  const double mean = sum_[pair] / frames;
  const double scatter = frames_ > 1 ? (sum_of_squares_[pair] / frames - mean * mean) / (frames - 1) : 0;
  return {mean, std::sqrt(std::max(counting / (frames * frames), scatter))};
}

double contact_range(double compressibility_factor, double restitution) {
  constexpr double longest = 0.12;  // where a parabola is still good enough in a dilute gas
  const double share = restitution == 1 ? 0.375 : 0.1 * std::pow(restitution, 4);
  return std::min(share / (compressibility_factor - 1), longest);
}

}  // namespace sandglass
