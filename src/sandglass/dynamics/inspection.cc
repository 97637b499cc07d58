// Looks through the engine's tables for anything that cannot be.
#include "sandglass/dynamics/inspection.h"

#include <cmath>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// What is wrong with disk i by itself.
Fault IsaEngine::fault_of(std::uint32_t i) const {
  const Record& disk = records_[i];
  const ColdRecord& cold = cold_[i];
  auto finite = [](double value) { return std::fabs(value) < never; };
  if (!finite(disk.x) || !finite(disk.y) || !finite(disk.vx) || !finite(disk.vy) || !finite(disk.time))
    return Fault::not_a_number;
  if (!(disk.x >= 0 && disk.x < box_.length && disk.y >= 0 && disk.y < box_.length)) return Fault::outside_box;
  if (disk.species >= species_count || disk.radius != state_.mixture.radius[disk.species]) return Fault::wrong_radius;
  if (disk.time > state_.now || cold.last_contact > state_.now) return Fault::time_order;
  const double flight = state_.now - disk.time;
  if (std::fmax(std::fabs(disk.vx), std::fabs(disk.vy)) * flight > 1.000001 * box_.transit)
    return Fault::overdue_transit;
  if (!(disk.next_time > state_.now && cold.next_kick > state_.now && disk.next_time <= cold.next_kick))
    return Fault::missed_event;
  const bool meets = disk.next == Next::contact || disk.next == Next::contact_entered_by_partner;
  if (meets != (disk.partner != no_disk)) return Fault::one_sided;
  if (meets) {
    if (disk.partner >= size_) return Fault::one_sided;
    const Record& partner = records_[disk.partner];
    if (partner.partner != i || partner.next_time != disk.next_time || partner.next == disk.next)
      return Fault::one_sided;
  }
  const double dx = neighbours_.grid().offset(cold.centre.x, std::fma(disk.vx, flight, disk.x));
  const double dy = neighbours_.grid().offset(cold.centre.y, std::fma(disk.vy, flight, disk.y));
  if (std::sqrt(dx * dx + dy * dy) > leash_ + 1e-9) return Fault::astray;
  return Fault::none;
}

Inspection IsaEngine::inspect() {
  Inspection result;
  auto found = [&](Fault fault, std::uint32_t i, std::uint32_t k) {
    return Inspection{fault, cold_[i].id, k < size_ ? cold_[k].id : no_disk, {}, {}, {}};
  };
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Record& disk = records_[i];
    if (const Fault fault = fault_of(i); fault != Fault::none) return found(fault, i, disk.partner);
    if (!neighbours_.complete(i, cold_[i].centre, disk)) return found(Fault::wrong_list, i, no_disk);
    for (std::uint32_t n = 0; n < disk.neighbour_count; ++n) {
      const std::uint32_t k = neighbours_.list(i)[n];
      const double contact = disk.radius + records_[k].radius;
      if (surface_gap(disk, records_[k], contact, state_.now, box_) < -1e-9 * contact)
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
