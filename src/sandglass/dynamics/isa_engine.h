// The engine of one instruction set: its tables and what it does with them. engine.cc has the loop over events,
// prediction.cc what comes next for a disk, partner.cc the search for the partner of a kick, loading.cc the way from
// and to a State, inspection.cc the self-check. All of them are compiled once per instruction set.
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
  void forget_what_comes() override;
  void store(Disk* disks) const override;
  void run(double end) override;
  Inspection inspect() override;
  void make_frame(double* x, double* y, double* vx, double* vy) const override;

 private:
  friend struct PredictionPerf;  // measures the search (prediction.perf.cc)
  friend struct FaultInjection;  // damages the tables, to see that it is found (watch.test.cc)

  struct Image {
    std::int32_t x, y;
  };
  struct Collision {
    std::uint32_t i, j;
    Flight a, b;  // after it
    Image image_a, image_b;
    Impact impact;
    bool elastic;  // by the TC model
  };
  struct Lanes {  // the contacts of one block of a list
    double soonest;
    unsigned all, strict;  // lanes with the soonest time; those that come strictly before what the other has next
  };
  struct Foreseen {
    double time;
    std::uint32_t partner;
  };

  void on_contact(std::uint32_t i, std::uint32_t j, double t);
  void on_kick(std::uint32_t i, double t);
  void on_transit(std::uint32_t i, double t);
  void on_review(std::uint32_t i, double t);
  [[nodiscard]] Collision collision(std::uint32_t i, std::uint32_t j, double t) const;
  void carry_out(const Collision& result);
  double push(std::uint32_t i, double t, double px, double py);
  void remake_list(std::uint32_t i, double t);
  void check_progress(double t);
  void fetch_disk(std::uint32_t i) const;
  void fetch_neighbours(std::uint32_t i) const;

  void predict(std::uint32_t i);
  void settle(std::uint32_t i, Lanes begun);
  void schedule(std::uint32_t i, Foreseen contact);
  void part(std::uint32_t i);
  [[nodiscard]] Foreseen earliest_contact(std::uint32_t i) const;
  [[nodiscard]] Foreseen earliest_contact_by_rule(std::uint32_t i) const;
  [[nodiscard]] Lanes contacts_of_block(const Flight& disk, double disk_radius, const std::uint32_t* list,
                                        std::uint32_t except) const;
  [[nodiscard]] Lanes first_contacts(std::uint32_t i, const Flight& flight, std::uint32_t except) const;
  [[nodiscard]] Foreseen earliest_of_blocks(std::uint32_t i, Lanes lanes) const;
  [[nodiscard]] bool within_leash(const Record& disk, const ColdRecord& cold, double t) const;
  [[nodiscard]] double list_expiry(const Record& disk, const ColdRecord& cold) const;
  [[nodiscard]] bool comes_before_next_of(const Record& other, double t, std::uint32_t i) const;

  std::uint32_t nearest_partner(std::uint32_t i, double t);
  [[nodiscard]] Smallest smallest_gap(const Record& disk, const std::uint32_t* list, double t) const;
  std::uint32_t partner_within_reach(std::uint32_t i, double t, const Kick& kick);

  [[nodiscard]] Fault fault_of(std::uint32_t i) const;
  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const;
  void log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const;
  [[nodiscard]] double mean_lead() const;
  [[nodiscard]] double window_events() const;
  [[nodiscard]] double default_skin() const;
  [[nodiscard]] double default_cell_size() const;

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
  double leash_ = 0;  // how far a disk may move from the centre of its list
  Calendar calendar_;
  std::uint64_t until_stall_check_ = 1;
  double progress_time_ = -never;
  GrowingArray<DiskName> candidates_;  // possible partners of a kick
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
