// Looks through the engine's tables for anything that cannot be.
#include "sandglass/dynamics/inspection.h"

#include <cmath>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// What is wrong with disk i by itself.
Fault IsaEngine::fault_of(std::uint32_t i) {
  const Record& disk = tables_.records[i];
  const ColdRecord& cold = tables_.cold[i];
  auto finite = [](double value) { return std::fabs(value) < never; };
  if (!finite(disk.x) || !finite(disk.y) || !finite(disk.vx) || !finite(disk.vy) || !finite(disk.time))
    return Fault::not_a_number;
  if (!(disk.x >= 0 && disk.x < tables_.box.length && disk.y >= 0 && disk.y < tables_.box.length))
    return Fault::outside_box;
  if (disk.species >= species_count || disk.radius != state_.mixture.radius[disk.species]) return Fault::wrong_radius;
  if (disk.time > state_.now || cold.last_contact > state_.now) return Fault::time_order;
  const double flight = state_.now - disk.time;
  if (std::fmax(std::fabs(disk.vx), std::fabs(disk.vy)) * flight > 1.000001 * tables_.box.transit)
    return Fault::overdue_transit;
  if (!(disk.next_time > state_.now && cold.next_kick > state_.now && disk.next_time <= cold.next_kick))
    return Fault::missed_event;
  const bool meets = disk.next == Next::contact || disk.next == Next::contact_entered_by_partner;
  if (meets != (disk.partner != no_disk)) return Fault::one_sided;
  if (meets) {
    if (disk.partner >= tables_.size) return Fault::one_sided;
    const Record& partner = tables_.records[disk.partner];
    if (partner.partner != i || partner.next_time != disk.next_time || partner.next == disk.next)
      return Fault::one_sided;
  }
  const Grid& grid = whole_.neighbours().grid();
  const auto [x, y] = position_at(disk, state_.now);
  const double dx = grid.offset(cold.centre.x, x), dy = grid.offset(cold.centre.y, y);
  // The grid rounds positions, in a large box by more than anything else; the leash leaves room for that.
  if (std::sqrt(dx * dx + dy * dy) > tables_.leash[disk.roomy] + 1e-9 + 4 * grid.unit()) return Fault::astray;
  return Fault::none;
}

Inspection IsaEngine::inspect() {
  Neighbours& neighbours = whole_.neighbours();
  neighbours.refresh();
  Inspection result;
  auto found = [&](Fault fault, std::uint32_t i, std::uint32_t k) {
    return Inspection{fault, tables_.ids[i], k < tables_.size ? tables_.ids[k] : no_disk, {}, {}, {}};
  };
  for (std::uint32_t i = 0; i < tables_.size; ++i) {
    const Record& disk = tables_.records[i];
    if (const Fault fault = fault_of(i); fault != Fault::none) return found(fault, i, disk.partner);
    if (!neighbours.complete(i, tables_.cold[i].centre, disk)) return found(Fault::wrong_list, i, no_disk);
    for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
      const std::uint32_t k = neighbours.listed(i, n);
      const double contact = disk.radius + tables_.records[k].radius;
      if (surface_gap(disk, tables_.records[k], contact, state_.now, tables_.box) < -1e-9 * contact)
        return found(Fault::overlap, i, k);
    }
    const double mass = state_.mixture.mass[disk.species];
    result.energy.add(0.5 * mass * (disk.vx * disk.vx + disk.vy * disk.vy));
    result.momentum_x.add(mass * disk.vx);
    result.momentum_y.add(mass * disk.vy);
  }
  return result;
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
