// Time-driven molecular dynamics of dissipative soft disks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sandglass {

/// One soft disk: a cache line. Units: stiffness k = 1, R_s = 1, m_s = 1.
struct SoftDisk {
  double x = 0, y = 0;    ///< centre, in [0, L) when the lists were last made, not always in between
  double vx = 0, vy = 0;  ///< velocity half a step before the time of the centre
  double fx = 0, fy = 0;  ///< force at the time of the centre
  double radius = 0, inverse_mass = 0;
};

/// Soft disks in a periodic square. Two of them closer than the contact distance s = swelling * (R_i + R_j) push each
/// other along the line n of their centres with
///   F = k (s - r) - gamma (v_i - v_j).n,
/// a linear spring and a dashpot [Cundall 1979]. gamma = 0.4 gives a restitution of about 0.4 between small disks and
/// 0.5 between big ones of 1.43 times the radius. Integrated with velocity Verlet in its leapfrog form; the time step
/// 0.25 is a third of the stability limit 2 / omega_max, with omega_max = sqrt(6) that of a triangular packing.
///
/// For speed the disks are kept in the order of cells, each with a Verlet list of partners in later slots; both are
/// remade when two disks may have come closer by the skin. Forces are summed in a fixed order: same start, same bits.
class SoftDisks {
 public:
  static constexpr double stiffness = 1, dashpot = 0.4, time_step = 0.25;
  static constexpr double skin = 0.5;  ///< in units of the largest radius; less in boxes below 7.5 of them

  /// Disks by id, fewer than 2^32, in a box with L >= 7 max R (three cells a side, unique nearest images).
  SoftDisks(double box_length, std::vector<SoftDisk> disks);

  /// Advances by one time step, with contact distances scaled by `swelling` in (0, 1].
  void step(double swelling);

  /// The largest 1 - r / (R_i + R_j) among all pairs, or 0.
  [[nodiscard]] double deepest_overlap() const;

  /// In the order of cells: disks()[slot] belongs to ids()[slot].
  [[nodiscard]] const std::vector<SoftDisk>& disks() const { return disks_; }
  [[nodiscard]] const std::vector<std::uint32_t>& ids() const { return ids_; }

 private:
  struct Point {
    double x = 0, y = 0;
  };

  void move();
  void apply_forces(double swelling);
  void remake_lists();
  void sort_by_cell();
  void list_partners();
  void list_among(const SoftDisk& disk, std::uint32_t first, std::uint32_t last);

  double box_length_;
  double skin_;
  std::size_t cells_ = 3;  ///< per side
  bool lists_due_ = false;
  std::vector<SoftDisk> disks_, sorted_disks_;  ///< the second is scratch, as sorted_ids_
  std::vector<std::uint32_t> ids_, sorted_ids_;
  std::vector<Point> listed_at_;            ///< centres when the lists were made
  std::vector<std::uint32_t> cell_start_;   ///< first slot of each cell, and one past the last
  std::vector<std::uint32_t> partners_;     ///< slots, list after list
  std::vector<std::uint32_t> partner_end_;  ///< where the list of each slot ends
};

}  // namespace sandglass
