// A strip of the plane and the loop over its events: what one thread works on. Without threads one strip is the whole
// plane. strip.cc has the loop, prediction.cc what comes next for a disk, partner.cc the search for the partner of a
// kick, freezing.cc what must be left to another strip. All of them are compiled once per instruction set.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/batch.h"
#include "sandglass/dynamics/calendar.h"
#include "sandglass/dynamics/contact.h"
#include "sandglass/dynamics/drive.h"
#include "sandglass/dynamics/engine.h"
#include "sandglass/dynamics/neighbours.h"
#include "sandglass/dynamics/record.h"
#include "sandglass/dynamics/tables.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Rows of the grid, from `first` upwards, periodically.
struct Rows {
  std::uint32_t first = 0, count = 0, side = 1;

  /// Less so many at either end.
  [[nodiscard]] Rows without(std::uint32_t rows) const {
    return {(first + rows) % side, count > 2 * rows ? count - 2 * rows : 0, side};
  }
  [[nodiscard]] bool hold(std::uint32_t row) const { return (row >= first ? row - first : row + side - first) < count; }
};

/// An entry for the calendar of the strip that holds the row where the disk stands.
struct Entry {
  double time;
  std::uint32_t slot, row;
};

class alignas(128) Strip {
 public:
  Strip() = default;
  explicit Strip(Tables& tables);  ///< the whole plane
  /// The rows `core`; its disks have neighbours up to `reach` rows beyond, and the next strip is `lane` rows away.
  Strip(Tables& tables, Rows core, std::uint32_t reach, std::uint32_t lane);

  // -- one after the other, without threads
  /// Enters a disk that has no list. Returns its slot's neighbours by neighbours().list().
  void enter_list(std::uint32_t slot) { neighbours_.enter(slot, cold_[slot].centre, records_); }
  [[nodiscard]] Neighbours& neighbours() { return neighbours_; }
  /// Where a disk's list is to be made.
  void set_centre(std::uint32_t i, FixedPoint centre) {
    cold_[i].centre = centre;
    records_[i].roomy = tables_->zone(neighbours_.grid().row_of(centre)) == Tables::Zone::roomy;
  }
  void set_calendar(Calendar calendar) { calendar_ = std::move(calendar); }
  void enter_calendar(std::uint32_t i);
  void predict(std::uint32_t i);

  /// Does every event at or before `end`.
  void run(double end);

  // -- in a window, see windows.cc and freezing.cc
  /// Enters what a later pass has found to come after the window, as far as it belongs here.
  void take_over(const Strip& other);
  void clear_outbox() { outbox_.clear(); }
  void sift_outbox();
  /// Freezes all disks of these rows from the start of the window on.
  void freeze_rows(Rows rows);
  /// The window's events of the strip's own disks.
  void first_pass();
  /// Goes on with those disks frozen by some strips that stand here.
  void begin_later_pass();
  void resume(const Strip& other);
  void later_pass();

  [[nodiscard]] std::size_t left() const { return left_.size(); }
  [[nodiscard]] std::uint32_t resumed() const { return resumed_; }
  [[nodiscard]] bool owns(std::uint32_t i) const { return whole_ || core_.hold(row(i)); }
  /// Enters what comes next for the strip's own disks, and forgets all else.
  void remake_calendar();
  /// Whether a disk has come through a lane from one strip to another since this was last asked.
  [[nodiscard]] bool crossed() { return std::exchange(crossed_, false); }
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] bool too_fast() const { return too_fast_; }
  [[nodiscard]] bool too_deep() const { return too_deep_; }

  /// Adds what was counted to `tally` and `bookkeeping`, and begins anew.
  void hand_in(Tally& tally, Simulation::Bookkeeping& bookkeeping);

  std::vector<Event>* log = nullptr;

 private:
  friend struct PredictionPerf;  // measures the search (prediction.perf.cc)

  struct Collision {
    std::uint32_t i, j;
    Flight a, b;  // after it
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
  struct FrozenKick {  // a frozen disk's clock rings: its kick number `count`
    double time;
    std::uint64_t count;
    std::uint32_t slot;
    friend bool operator<(const FrozenKick& a, const FrozenKick& b) { return a.time > b.time; }  // for a heap
  };
  struct Menace {  // what the frozen disks of its list mean for a known disk on its present flight
    bool any = false;
    double touch = never;  // when one of them can touch it at the earliest
  };
  struct Left {  // a frozen disk and the row in which it stands
    std::uint32_t slot, row;
  };

  // several events together, see batch.cc
  bool run_batch();
  void gather();
  bool describe(unsigned m, unsigned& special);
  void fly();
  unsigned collide_all();
  void search_listed();
  void approach_listed(unsigned n);
  void meet_listed(unsigned n);
  void search_far();
  void foresee_all_else();
  void carry_out_batch();
  [[nodiscard]] std::uint32_t nobody() const { return static_cast<std::uint32_t>(tables_->size); }

  void on_contact(std::uint32_t i, std::uint32_t j, double t);
  void on_kick(std::uint32_t i, double t);
  void on_transit(std::uint32_t i, double t);
  void on_review(std::uint32_t i, double t);
  [[nodiscard]] Collision collision(std::uint32_t i, std::uint32_t j, double t);
  void carry_out(const Collision& result);
  [[nodiscard]] Kick next_kick(std::uint32_t i, double t);
  void draw_kicks(std::uint32_t i, double t);
  void enter_next_kick(std::uint32_t i);
  void enter_kick_again(std::uint32_t i);
  double kick_alone(std::uint32_t i, double t, double px, double py);
  double kick_pair(std::uint32_t i, std::uint32_t j, double t, double px, double py);
  bool remake_list(std::uint32_t i, double t);
  void tell_listed(std::uint32_t i);
  void give_up();
  /// Whether the list of a disk that stands in this row may be made anew: those of its neighbours change. In the first
  /// pass the disks of a narrow lane are also seen from its other side.
  [[nodiscard]] bool may_change_lists_at(std::uint32_t row) const {
    const bool narrow = first_pass_ && lane_ < 2 * reach_;
    return (narrow ? core_.without(reach_) : core_).hold(row);
  }
  void check_progress(double t);
  void fetch_ahead();
  void fetch_within_cache(std::size_t n) const;
  [[nodiscard]] std::uint32_t partner_or_self(std::uint32_t i) const {
    return records_[i].partner == no_disk ? i : records_[i].partner;
  }
  void fetch_listed_ahead() const;
  void fetch_others_ahead() const;
  void fetch_disks(std::uint32_t i) const;
  void fetch_disk(std::uint32_t i) const;
  void fetch_listed(std::uint32_t i) const;
  void fetch_others(std::uint32_t i) const;
  void fetch_grid(const Record& disk) const;
  void fetch_kick_partner(std::uint32_t i);
  void fetch_partners_neighbours(std::uint32_t i) const;

  void settle(std::uint32_t i, Lanes begun);
  void schedule(std::uint32_t i, Foreseen contact);
  void enter_event(double t, std::uint32_t i);
  void lose_partner(std::uint32_t i, double t, bool entered_by_partner);
  void leave_partner(const Record& disk);
  [[nodiscard]] Foreseen earliest_contact(std::uint32_t i) const;
  [[nodiscard]] Foreseen earliest_contact_by_rule(std::uint32_t i) const;
  template <class Amend>
  [[nodiscard]] Lanes contacts_of_block(const Flight& disk, double disk_radius, const std::uint32_t* list,
                                        Amend&& amend) const;
  [[nodiscard]] Lanes first_contacts(std::uint32_t i, const Flight& flight, std::uint32_t except) const;
  [[nodiscard]] Lanes first_contacts(std::uint32_t i, const Flight& flight, std::uint32_t other,
                                     const Flight& other_flight) const;
  [[nodiscard]] Foreseen earliest_of_blocks(std::uint32_t i, Lanes lanes) const;
  [[nodiscard]] bool within_leash(const Record& disk, const ColdRecord& cold, double t) const;
  [[nodiscard]] double list_expiry(const Record& disk, const ColdRecord& cold) const;
  [[nodiscard]] bool comes_before_next_of(const Record& other, double t, std::uint32_t i) const;

  static constexpr std::uint32_t undecided = no_disk - 1;  // in place of a partner: a frozen disk may be nearer
  std::uint32_t nearest_partner(std::uint32_t i, double t);
  struct Nearest {
    std::uint32_t slot;
    double gap;
  };
  [[nodiscard]] Nearest nearest_listed(std::uint32_t i, double t) const;
  [[nodiscard]] bool nobody_unlisted_within(double gap, std::uint32_t i, double t) const;
  [[nodiscard]] Smallest smallest_gap(const Record& disk, const std::uint32_t* list, double t) const;
  std::uint32_t partner_within_reach(std::uint32_t i, double t, const Kick& kick);

  void begin_pass();
  void end_pass();
  template <class Visit>
  void visit(Rows rows, Visit&& visit);
  static constexpr std::size_t visits_ahead = 16;
  void fetch_visited(std::uint32_t i) const { prefetch(&records_[i]), fetch_disk(i); }
  void freeze(std::uint32_t i, double t);
  void freeze_no_later(std::uint32_t i, double t);
  void find_home(std::uint32_t i);
  [[nodiscard]] double freezing_time(std::uint32_t i);
  [[nodiscard]] double earliest_touch(const Record& disk, const Record& ghost) const;
  [[nodiscard]] Menace menace(std::uint32_t i) const;
  void menace_listed(std::uint32_t i);
  void concern(std::uint32_t i);
  void check_speed(const Record& disk);
  void run_window();
  void expect_kick(std::uint32_t frozen_disk);
  void on_frozen_kick(const FrozenKick& kick);
  [[nodiscard]] double since(const Record& frozen_disk) const {
    return tables_->window.start + frozen_after(frozen_disk.next_time);
  }
  [[nodiscard]] double gap_at(std::uint32_t i, double t, std::uint32_t k, double t_k) const;
  [[nodiscard]] bool is_done_at(std::uint32_t k, double t) const;
  [[nodiscard]] double growth(std::uint32_t frozen_disk, double t) const;
  [[nodiscard]] bool is_done(std::uint32_t i) const { return !first_pass_ && !records_[i].concerned; }
  [[nodiscard]] std::uint32_t row(std::uint32_t i) const { return neighbours_.grid().row_of(cold_[i].centre); }

  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const;
  void log_event(EventKind kind, double t, std::uint32_t i, std::uint32_t j) const;
  [[nodiscard]] double inverse_mass(const Record& disk) const { return masses_[disk.species][disk.species].inverse_a; }
  [[nodiscard]] double largest_radius() const { return box_.length / 4 - box_.transit; }

  const Tables* tables_ = nullptr;
  Record* records_ = nullptr;
  ColdRecord* cold_ = nullptr;
  const std::uint32_t* ids_ = nullptr;
  Image* images_ = nullptr;
  Box box_{1, {}};
  PairMasses masses_[species_count][species_count];
  CollisionLaw law_;
  double leash_[2] = {0, 0};
  std::uint32_t range_ = 0;  // the longest of the lists, in units of the grid's fixed point
  Neighbours neighbours_;
  Calendar calendar_;
  double end_ = 0;              // of the present run
  double outbox_from_ = never;  // what comes later is not for this strip's calendar
  std::uint64_t until_stall_check_ = 1;
  double progress_time_ = -never;
  Tally tally_;
  Simulation::Bookkeeping bookkeeping_;
  GrowingArray<DiskName> candidates_;       // possible partners of a kick
  Batch batch_{};                           // events that come next, worked out together
  DrawnKicks drawn_kicks_{};                // some that come soon
  double drawn_until_ = -never;             // when the last of them comes
  std::uint32_t upcoming_ = no_disk;        // whose event is so near that its neighbours are to be fetched
  std::uint32_t likely_partners_[16] = {};  // of kicks that come soon, by slot modulo 16; only for what to fetch

  Rows core_;                // the disks that stand here are the strip's own
  std::uint32_t reach_ = 0;  // rows beyond in which they have neighbours
  std::uint32_t lane_ = 0;   // rows to the next strip
  bool whole_ = true;        // no other thread is at work
  bool first_pass_ = true;
  bool frozen_about_ = false;              // in a later pass: some are frozen that may be met
  bool crossed_ = false;                   // a disk has come from one strip to another
  bool failed_ = false;                    // the window must be undone
  bool too_fast_ = false;                  // because a disk was faster than trusted
  bool too_deep_ = false;                  // because one would be frozen farther from the lanes than expected
  GrowingArray<FrozenKick> frozen_kicks_;  // a heap
  GrowingArray<std::uint32_t> suspects_;   // may be nearest to a frozen disk that kicks
  GrowingArray<std::uint32_t> in_row_;     // for visit
  GrowingArray<Left> left_;                // frozen in this pass
  GrowingArray<std::uint32_t> concerned_;  // in this pass
  std::uint32_t resumed_ = 0;              // frozen in an earlier pass, not in this one
  GrowingArray<Entry> outbox_;
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
