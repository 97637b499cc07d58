// The engine of one instruction set: the disks, and the strips that work on them. loading.cc has the way from and to a
// State, windows.cc how several threads share the work, inspection.cc
// the self-check.
#pragma once

#include <memory>

#include "sandglass/dynamics/engine.h"
#include "sandglass/dynamics/strip.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

class IsaEngine final : public Engine {
 public:
  IsaEngine(State& state, const Tuning& tuning) : state_(state), tuning_(tuning), tables_(state) {}

  OverlappingPair load(const std::uint32_t* order) override;
  void forget_what_comes() override;
  void store(Disk* disks) const override;
  void run(double end) override;
  Inspection inspect() override;
  [[nodiscard]] unsigned threads() const override { return strips_; }
  void make_frame(double* x, double* y, double* vx, double* vy) const override;

 private:
  friend struct PredictionPerf;  // measures the search (prediction.perf.cc)
  friend struct FaultInjection;  // damages the tables, to see that it is found (watch.test.cc)

  OverlappingPair make_lists();
  void make_calendar();
  [[nodiscard]] bool works_in_batches() const;
  [[nodiscard]] Fault fault_of(std::uint32_t i);
  [[nodiscard]] double mean_lead() const;
  [[nodiscard]] Calendar calendar_for(double lead, std::size_t size) const;
  [[nodiscard]] double default_skin() const;
  [[nodiscard]] double default_cell_size() const;

  [[nodiscard]] std::uint32_t strips_for_threads(const Neighbours& neighbours);
  [[nodiscard]] std::uint32_t lane_rows(const Neighbours& neighbours) const;
  [[nodiscard]] std::uint32_t border(std::uint32_t s) const;
  void make_zones(const Neighbours& neighbours);
  void divide();
  void survey();
  [[nodiscard]] double balance() const;
  [[nodiscard]] bool temperature_has_changed() const;
  void keep();
  void find_homes();
  [[nodiscard]] double way() const { return window_part_ * tables_.neighbours.skin; }
  [[nodiscard]] double window_length() const;
  void do_window(double end);
  [[nodiscard]] bool any_failed() const;
  void undo(double start, double end);
  void hand_in();
  void replenish();

  State& state_;
  Tuning tuning_;
  Tables tables_;
  Strip whole_;

  // Where several threads work (windows.cc):
  std::uint32_t strips_ = 1;
  std::uint32_t reach_ = 0;           // rows that a search may be away from its disk
  std::unique_ptr<Strip[]> first_;    // the strips of the first pass
  std::unique_ptr<Strip[]> shifted_;  // those of the second, around the borders of the first
  std::unique_ptr<Rows[]> lanes_;     // between the strips of the first pass
  std::uint32_t lane_ = 0;            // rows of each of these
  double window_part_ = 0;            // how far the fastest disk may fly in a window, in skins
  double top_speed_[species_count] = {0, 0};
  std::uint32_t longest_list_ = 0;
  double surveyed_energy_ = 0, surveyed_balance_ = 0;  // at the last survey
  double caution_ = 1;         // grows with every window that had to be undone since a disk was too fast
  double freezing_depth_ = 0;  // how far from the lanes disks are frozen; grows where that is not enough
  struct KeptDisk {
    Record record;
    double last_contact, next_kick;
    std::uint64_t kick_count;
    Image image;
  };
  Array<KeptDisk> kept_;  // the disks some windows ago
  Tally kept_tally_;
  double kept_now_ = 0;
  static constexpr unsigned windows_between_copies = 96;  // a copy takes about as long as a window
  unsigned windows_since_kept_ = 0;
  std::uint64_t windows_done_ = 0, undone_ = 0;  // since the disks were loaded
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
