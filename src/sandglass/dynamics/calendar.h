// The event calendar: which disk's event is next, in constant time.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/record.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// Time is cut into windows of some hundred events. An entry of a later window is only appended to that window's chain
/// of chunks; when a window opens, its entries are sorted, and are then taken one after the other. What is entered into
/// the window while it is open, a small part, is kept unsorted beside them (late). Nothing is moved or removed when a
/// prediction changes: an entry counts only while it still states its disk's next_time. What does not count is left out
/// when its window opens; or, where the disks' records do not fit into the cache and would have to be brought twice,
/// some events before its turn.
/// Nearly all branches here go the same way nearly always; those of a heap, or of a bucket of a few events, do not, and
/// that costs more than the work.
class Calendar {
 public:
  /// `size` entries live at a time, `lead` ahead in the mean; a window is `window` long, from time `start` on.
  /// `out_of_cache`: whether the disks' records do not fit into the cache.
  Calendar(double start, double lead, double window, std::size_t size, bool out_of_cache)
      : start_(start), inverse_width_(1 / window), lead_(lead), out_of_cache_(out_of_cache) {
    while (keys_ < 16384 && static_cast<double>(keys_) * lead < 4 * static_cast<double>(size) * window) keys_ *= 2;
    std::size_t windows = 16;
    while (windows < 65536 && static_cast<double>(windows) * window < 4 * lead) windows *= 2;
    ring_mask_ = static_cast<std::int64_t>(windows) - 1;
    chains_ = Array<std::uint32_t>(windows + 1);
    for (std::uint32_t& chain : chains_) chain = no_chunks;
    firsts_ = Array<std::uint32_t>(keys_ + 1);
    make_room(64);
    open(0);
  }
  Calendar() = default;

  [[gnu::always_inline]] void push(double time, std::uint32_t slot) {
    const std::int64_t window = window_of(time), ahead = window - window_;
    if (ahead <= 0)
      enter_late(time, slot);
    else
      append(ahead <= ring_mask_ ? static_cast<std::size_t>(window & ring_mask_) : beyond(), time, slot);
  }

  /// Enters again what has been entered before, if its window is open and it may have been left out, since it did not
  /// count when that was opened.
  [[gnu::always_inline]] void push_again(double time, std::uint32_t slot) {
    if (window_of(time) <= window_) enter_late(time, slot);
  }

  /// An entry of the open window, the n-th from the next on (n < 32), of those there when it opened.
  struct Coming {
    double time;
    std::uint32_t slot;
  };
  [[nodiscard]] Coming coming(std::size_t n) const { return {sorted_[head_ + n].time, sorted_[head_ + n].slot}; }

  /// The earliest of what has been entered into the open window since it opened.
  [[nodiscard]] double late_soonest() const { return late_soonest_; }

  /// Takes out the earliest of what was entered late, and returns its slot; no_disk, and nothing, if there are several
  /// at one time.
  std::uint32_t take_late() {
    const Choice choice = soonest_late();
    if (choice.slot != no_disk) take(choice);
    return choice.slot;
  }
  /// Puts back what take_late has taken out.
  void put_back(double time, std::uint32_t slot) { enter_late(time, slot); }

  /// Takes out the next `count` of the sorted entries.
  void take_ahead(std::size_t count) { head_ += count; }

  /// Some three leads ahead: what comes later for a slot need not be entered yet, it is enough to look again then. Most
  /// often something else will have come before, and the entry would only have been in the way. Not the same time for
  /// any two slots: entries at one time are slow to order.
  [[nodiscard]] double horizon(std::uint32_t slot) const {
    return closes_ + lead_ * (2.7 + 0.9 * 0x1p-32 * (slot * 0x9e3779b9u));
  }

  /// Goes on from time t, after everything before it has been taken out and while nothing later is in.
  void skip_to(double t) {
    if (window_of(t) > window_) open(window_of(t));
  }

  /// Forgets all entries. Time goes on from where it is, and the memory is kept.
  void clear() {
    for (std::uint32_t& chain : chains_) chain = no_chunks;
    chunks_.clear();
    nexts_.clear();
    free_ = none;
    for (std::size_t i = 0; i < late_count_; ++i) late_times_[i] = nothing;
    late_count_ = 0;
    late_soonest_ = nothing;
    begin_sorted(0);
  }

  /// Takes out and returns the slot whose event is the earliest and not after `limit`; no_disk if there is none.
  /// `before(a, b)` orders two slots whose events are at the same time.
  template <class Before>
  [[gnu::always_inline]] std::uint32_t pop(const Record* records, double limit, Before&& before) {
    for (;;) {
      if (head_ + look_ahead >= seen_ && unseen_ < end_) [[unlikely]]
        see_more(records);
      const Entry next = sorted_[head_];
      if (late_soonest_ <= next.time || next.time == sorted_[head_ + 1].time) [[unlikely]] {
        if (late_soonest_ == nothing && next.time == nothing) {
          if (window_ >= window_of(limit)) return no_disk;
          open_next_window(records);
        } else if (late_soonest_ > next.time && next.slot == sorted_[head_ + 1].slot) {
          ++head_;  // one entry twice: a disk may have found again and again that its kick comes next
        } else if (unseen_ < end_ && sorted_[seen_ - 1].time == next.time) {
          see_more(records);  // there may be more at that time
        } else if (const Choice choice = first_of_ties(records, before); choice.time > limit) {
          return no_disk;
        } else if (take(choice); states(records[choice.slot], choice.time)) {
          return choice.slot;
        }
        continue;
      }
      if (next.time > limit) return no_disk;
      ++head_;
      if (states(records[next.slot], next.time)) [[likely]]
        return next.slot;
    }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr double nothing = std::numeric_limits<double>::infinity();
  static constexpr std::size_t beyond_end = 40;  // entries for nobody after the sorted ones
  static constexpr std::size_t look_ahead = 32;  // sorted entries that are known to count, if there are so many

  struct Entry {
    double time;
    std::uint32_t slot;
    std::uint32_t key;  // place in the open window, in 1/keys_ of it
  };

  /// An entry of the open window: sorted_[place], or of the late ones.
  struct Choice {
    double time = nothing;
    std::uint32_t slot = no_disk;
    bool late = false;
    std::size_t place = 0;
  };

  /// A run of entries of one later window. Packed; how far it is full, and which chunk was filled before, stand
  /// elsewhere (chains_, nexts_): appending writes to it, and walking a chain passes it, without waiting for it.
  struct alignas(64) Chunk {
    static constexpr std::uint32_t capacity = 85, entry_bytes = 12;
    unsigned char entries[capacity * entry_bytes];

    [[gnu::always_inline]] void write(std::uint32_t i, double time, std::uint32_t slot) {
      std::memcpy(entries + i * entry_bytes, &time, sizeof time);
      std::memcpy(entries + i * entry_bytes + sizeof time, &slot, sizeof slot);
    }
    [[nodiscard]] double time(std::uint32_t i) const {
      double time;
      std::memcpy(&time, entries + i * entry_bytes, sizeof time);
      return time;
    }
    [[nodiscard]] std::uint32_t slot(std::uint32_t i) const {
      std::uint32_t slot;
      std::memcpy(&slot, entries + i * entry_bytes + sizeof(double), sizeof slot);
      return slot;
    }
  };
  static_assert(sizeof(Chunk) == 1024);

  /// The end of a chain: its last chunk and how many entries that holds; a chain without chunks is "full".
  static constexpr unsigned count_bits = 7;
  static_assert(Chunk::capacity < 1u << count_bits);
  static constexpr std::uint32_t no_chunks = none << count_bits | Chunk::capacity;
  static std::uint32_t chunk_of(std::uint32_t end) {
    return end >> count_bits == none >> count_bits ? none : end >> count_bits;
  }
  static std::uint32_t count_of(std::uint32_t end) { return end & ((1u << count_bits) - 1); }

  [[gnu::always_inline]] std::int64_t window_of(double time) const {
    const double window = (time - start_) * inverse_width_;
    return static_cast<std::int64_t>(window < 0x1p52 ? window : 0x1p52);  // from 2^52 on: never
  }

  /// Whether an entry counts. An entry's time is a copy: comparing bits spares a branch for NaN.
  [[gnu::always_inline]] static bool states(const Record& disk, double time) {
    return std::bit_cast<std::uint64_t>(disk.next_time) == std::bit_cast<std::uint64_t>(time);
  }

  /// The chain of what lies more than a turn of the ring ahead.
  [[nodiscard]] std::size_t beyond() const { return static_cast<std::size_t>(ring_mask_) + 1; }

  [[gnu::always_inline]] void enter_late(double time, std::uint32_t slot) {
    if (late_count_ == late_slots_.size()) [[unlikely]]
      more_late();
    late_times_[late_count_] = time;
    late_slots_[late_count_++] = slot;
    late_soonest_ = time < late_soonest_ ? time : late_soonest_;
  }

  [[gnu::noinline]] void more_late() {
    late_slots_.enlarge(2 * late_count_ + 64);
    late_times_.enlarge(late_slots_.size());
    for (std::size_t i = late_count_; i < late_times_.size(); ++i) late_times_[i] = nothing;
  }

  /// Of all entries at the earliest time, the first in order; any of them if none counts.
  template <class Before>
  [[gnu::noinline]] Choice first_of_ties(const Record* records, Before&& before) const {
    Choice best;
    bool best_counts = false;
    auto consider = [&](double time, std::uint32_t slot, bool late, std::size_t place) {
      const bool counts = states(records[slot], time);
      if (best.slot != no_disk && (!counts || (best_counts && !before(slot, best.slot)))) return;
      best = {time, slot, late, place};
      best_counts = counts;
    };
    const double earliest = late_soonest_ < sorted_[head_].time ? late_soonest_ : sorted_[head_].time;
    for (std::size_t i = head_; sorted_[i].time == earliest; ++i) consider(earliest, sorted_[i].slot, false, i);
    for (std::size_t i = 0; i < late_count_; ++i)
      if (late_times_[i] == earliest) consider(earliest, late_slots_[i], true, i);
    return best;
  }

  /// The earliest of the late entries, or no_disk if there are several at that time.
  [[nodiscard]] Choice soonest_late() const {
    Choice choice;
    for (std::size_t i = 0; i < late_count_; i += 8) {
      const auto [soonest, lanes] = smallest_of_8(&late_times_[i]);
      if (soonest != late_soonest_) continue;
      if (choice.slot != no_disk || (lanes & (lanes - 1)) != 0) return {};
      const std::size_t place = i + static_cast<unsigned>(__builtin_ctz(lanes));
      choice = {late_soonest_, late_slots_[place], true, place};
    }
    return choice;
  }

  void take(const Choice& choice) {
    if (!choice.late) {
      std::swap(sorted_[choice.place], sorted_[head_]);
      ++head_;
      return;
    }
    --late_count_;
    late_times_[choice.place] = late_times_[late_count_];
    late_slots_[choice.place] = late_slots_[late_count_];
    late_times_[late_count_] = nothing;
    late_soonest_ = nothing;
    for (std::size_t i = 0; i < late_count_; i += 8) {
      const double soonest = smallest_of_8(&late_times_[i]).value;
      late_soonest_ = soonest < late_soonest_ ? soonest : late_soonest_;
    }
  }

  [[gnu::always_inline]] void append(std::size_t chain, double time, std::uint32_t slot) {
    std::uint32_t& end = chains_[chain];
    if (count_of(end) == Chunk::capacity) [[unlikely]]
      end = new_chunk(chunk_of(end)) << count_bits;
    chunks_[end >> count_bits].write(count_of(end), time, slot);
    ++end;
  }

  [[gnu::noinline]] std::uint32_t new_chunk(std::uint32_t next) {
    std::uint32_t chunk = free_;
    if (chunk != none) {
      free_ = nexts_[chunk];
    } else {
      chunk = static_cast<std::uint32_t>(chunks_.size());
      chunks_.push_back({});
      nexts_.push_back(none);
    }
    nexts_[chunk] = next;
    return chunk;
  }

  /// Takes a whole chain and calls visit(time, slot) with its entries.
  template <class Visit>
  void empty_chain(std::size_t chain, Visit&& visit) {
    const std::uint32_t end = std::exchange(chains_[chain], no_chunks);
    std::uint32_t current = chunk_of(end);
    for (std::uint32_t count = count_of(end); current != none; count = Chunk::capacity) {
      for (std::uint32_t i = 0; i < count; ++i)  // visiting may move the chunks
        visit(chunks_[current].time(i), chunks_[current].slot(i));
      const std::uint32_t next = nexts_[current];
      nexts_[current] = free_;
      free_ = current;
      current = next;
    }
  }

  void open(std::int64_t window) {
    window_ = window;
    closes_ = start_ + static_cast<double>(window + 1) / inverse_width_;
  }

  [[gnu::noinline]] void open_next_window(const Record* records) {
    open(window_ + 1);
    const auto place = static_cast<std::size_t>(window_ & ring_mask_);
    if (place == 0) empty_chain(beyond(), [&](double time, std::uint32_t slot) { push(time, slot); });
    std::size_t room = 0;
    for (std::uint32_t chunk = chunk_of(chains_[place]); chunk != none; chunk = nexts_[chunk]) {
      room += Chunk::capacity;
      for (std::uint32_t line = 0; line < sizeof(Chunk); line += 64) prefetch(&chunks_[chunk].entries[line]);
    }
    if (room + beyond_end > sorted_.size()) make_room(room + beyond_end);

    // Sorted by key first (counting), which leaves few out of order. What counts is chosen without a branch, since that
    // cannot be foretold.
    const double scale = static_cast<double>(keys_) * inverse_width_,
                 origin = static_cast<double>(window_) * static_cast<double>(keys_);
    std::size_t count = 0;
    empty_chain(place, [&](double time, std::uint32_t slot) {
      const auto key = static_cast<std::int64_t>((time - start_) * scale - origin);
      const auto last = static_cast<std::int64_t>(keys_) - 1;
      unsorted_[count] = {time, slot, static_cast<std::uint32_t>(key < 0 ? 0 : key < last ? key : last)};
      count += out_of_cache_ || states(records[slot], time);
    });
    for (std::uint32_t& first : firsts_) first = 0;
    for (std::size_t i = 0; i < count; ++i) ++firsts_[unsorted_[i].key + 1];
    for (std::size_t key = 0; key < keys_; ++key) firsts_[key + 1] += firsts_[key];
    for (std::size_t i = 0; i < count; ++i) sorted_[firsts_[unsorted_[i].key]++] = unsorted_[i];
    for (std::size_t i = 1; i < count; ++i)
      for (std::size_t j = i; j > 0 && sorted_[j].time < sorted_[j - 1].time; --j)
        std::swap(sorted_[j], sorted_[j - 1]);
    begin_sorted(count);
    if (out_of_cache_)
      for (std::size_t i = 0; i < look_ahead; ++i) prefetch(&records[sorted_[i].slot]);
    else
      seen_ = unseen_ = count;
  }

  /// There are `count` sorted entries, none of which has been looked at.
  void begin_sorted(std::size_t count) {
    head_ = seen_ = unseen_ = 0;
    end_ = count;
    close_sorted(count);
  }
  void close_sorted(std::size_t end) {
    for (std::size_t i = end; i < end + beyond_end; ++i) sorted_[i] = {nothing, 0, 0};
  }

  /// Leaves out what does not count of the next sorted entries.
  [[gnu::noinline]] void see_more(const Record* records) {
    do {
      for (std::size_t n = 0; n < look_ahead && unseen_ < end_; ++n) {
        prefetch(&records[sorted_[unseen_ + look_ahead].slot]);
        const Entry entry = sorted_[unseen_++];
        sorted_[seen_] = entry;
        seen_ += states(records[entry.slot], entry.time);
      }
    } while (unseen_ < end_ && seen_ < head_ + 2 * look_ahead);
    if (unseen_ == end_) close_sorted(seen_);
  }

  [[gnu::noinline]] void make_room(std::size_t size) {
    sorted_ = Array<Entry>(size + size / 2);
    unsorted_ = Array<Entry>(size + size / 2);
    begin_sorted(0);
  }

  double start_ = 0, inverse_width_ = 1;  // of a window
  double lead_ = 0;                       // of an entry, in the mean
  bool out_of_cache_ = false;             // whether records must be fetched far ahead
  std::int64_t window_ = 0;               // the open one, counted from start_
  double closes_ = 0;                     // when that ends
  std::int64_t ring_mask_ = 0;            // number of windows in the ring, less 1
  Array<Entry> sorted_, unsorted_;        // what was known of the open window when it opened
  std::size_t head_ = 0;                  // the first of sorted_ not yet taken
  std::size_t seen_ = 0;                  // up to here sorted_ holds what counts,
  std::size_t unseen_ = 0, end_ = 0;      // and here what has not been looked at
  std::size_t keys_ = 16;                 // four for each event
  Array<std::uint32_t> firsts_;           // by key: where its entries begin in sorted_
  Array<double> late_times_;              // entered since; `nothing` from late_count_ on
  Array<std::uint32_t> late_slots_;
  std::size_t late_count_ = 0;
  double late_soonest_ = nothing;
  Array<std::uint32_t> chains_;  // the ring of windows, then beyond(): where each ends
  std::uint32_t free_ = none;    // chain of unused chunks
  GrowingArray<Chunk> chunks_;
  GrowingArray<std::uint32_t> nexts_;  // by chunk: that filled before it in its chain, or none
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
