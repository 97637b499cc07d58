#include "sandglass/report/packing.h"

#include <cmath>

#include "sandglass/core/frame.h"
#include "sandglass/observe/bond_order.h"

namespace sandglass {

Packing packing_of(const State& state, std::size_t most) {
  Packing packing;
  const double box = packing.box_length = packing.side = state.box_length;
  packing.radius = state.mixture.radius;
  if (state.size() > most) {
    packing.side = box * std::sqrt(static_cast<double>(most) / static_cast<double>(state.size()));
    packing.left = packing.bottom = (box - packing.side) / 2;
  }
  Frame frame;
  make_frame(state, frame);
  const std::vector<std::complex<double>> psi = bond_order(frame, population_of(state));
  auto shown = [&](double x) { return x >= packing.left && x < packing.left + packing.side; };
  for (std::size_t id = 0; id < state.size(); ++id) {
    const double x = frame.x[id] - box * std::floor(frame.x[id] / box);
    const double y = frame.y[id] - box * std::floor(frame.y[id] / box);
    if (packing.side < box && !(shown(x) && shown(y))) continue;
    packing.id.push_back(id);
    packing.x.push_back(x);
    packing.y.push_back(y);
    packing.species.push_back(state.disks[id].species);
    packing.psi.push_back(psi[id]);
  }
  return packing;
}

}  // namespace sandglass
