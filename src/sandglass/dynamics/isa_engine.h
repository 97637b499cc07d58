// The engine of one instruction set: its tables and what it does with them. engine.cc has the loop over events,
// prediction.cc what comes next for a disk, partner.cc the search for the partner of a kick, loading.cc the way from
// and to a State. All of them are compiled once per instruction set.
#pragma once

#include <cstdint>
#include <limits>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/calendar.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/drive.h"
#include "sandglass/dynamics/engine.h"
#include "sandglass/dynamics/neighbours.h"
#include "sandglass/dynamics/record.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

inline constexpr double never = std::numeric_limits<double>::infinity();

class IsaEngine final : public Engine {
 public:
  IsaEngine(State& state, const Tuning& tuning)
      : state_(state), tuning_(tuning), box_(state.box_length, state.mixture) {
    for (const int a : {small, big})
      for (const int b : {small, big}) masses_[a][b] = PairMasses(state.mixture.mass[a], state.mixture.mass[b]);
  }

  OverlappingPair load(const std::uint32_t* order) override;
  void store(Disk* disks) const override;
  void run(double end) override;
  void make_frame(double* x, double* y, double* vx, double* vy) const override;

 private:
  void on_contact(std::uint32_t i, std::uint32_t j, double t);
  void on_kick(std::uint32_t i, double t);
  void on_transit(std::uint32_t i, double t);
  void on_list_expiry(std::uint32_t i, double t);

  void check_progress(double t);

  void predict_pending();
  void predict(std::uint32_t i);
  struct Foreseen {
    double time;
    std::uint32_t partner;
  };
  [[nodiscard]] Foreseen earliest_contact(std::uint32_t i) const;
  void orphan(std::uint32_t i);
  void release(std::uint32_t i);
  [[nodiscard]] bool comes_before_next_of(const Record& other, double t, std::uint32_t i) const;
  [[nodiscard]] double list_expiry(const Record& disk, const ColdRecord& cold) const;
  [[nodiscard]] bool within_leash(const Record& disk, const ColdRecord& cold, double t) const;

  std::uint32_t nearest_partner(std::uint32_t i, double t);
  std::uint32_t partner_within_reach(std::uint32_t i, double t, const Kick& kick);

  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const;
  void log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const;
  [[nodiscard]] double mean_lead() const;
  [[nodiscard]] double default_skin() const;

  [[nodiscard]] double inverse_mass(const Record& disk) const { return masses_[disk.species][disk.species].inverse_a; }
  [[nodiscard]] double largest_radius() const { return box_.length / 4 - box_.transit; }

  State& state_;
  Tuning tuning_;
  Box box_;
  PairMasses masses_[species_count][species_count];  // by species of the first and the second disk
  std::size_t size_ = 0;
  Array<Record> records_;
  Array<ColdRecord> cold_;
  Neighbours neighbours_;
  Calendar calendar_;
  std::uint64_t until_stall_check_ = 1;
  double progress_time_ = -never;
  GrowingArray<std::uint32_t> pending_;  // disks without a next event, to be predicted before time goes on
  GrowingArray<DiskName> candidates_;    // possible partners of a kick
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
