// The event calendar: which disk's event is next, in constant time.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/record.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// A lazy two-level bucket calendar. Time is cut into fine buckets of a few events, and into windows of many fine
/// buckets; a ring of windows lies ahead. An entry of a later window is only appended to that window's chain of
/// chunks; when a window opens, its entries are dealt into fine buckets; the open bucket is searched for its earliest
/// entry. Nothing is moved or removed when a prediction changes: an entry counts only while it still states its disk's
/// next_time.
class Calendar {
 public:
  /// Fine buckets are `bucket_width` long, counted from time `start`; about `size` entries live at a time.
  Calendar(double start, double bucket_width, std::size_t size) : start_(start), inverse_width_(1 / bucket_width) {
    while (fine_bits_ < 8 && (std::size_t{1} << 2 * fine_bits_) < size) ++fine_bits_;
    unsigned ring_bits = fine_bits_;
    while (ring_bits < 16 && (std::size_t{1} << (fine_bits_ + ring_bits)) < size) ++ring_bits;
    fine_mask_ = (std::uint64_t{1} << fine_bits_) - 1;
    out_of_cache_ = size > 20000;
    ring_mask_ = (std::uint64_t{1} << ring_bits) - 1;
    lines_ = GrowingArray<Line>(fine_mask_ + 1);
    for (Line& line : lines_) line = Line();
    chains_ = Array<std::uint32_t>(ring_mask_ + 2);
    for (std::uint32_t& chain : chains_) chain = no_chunks;
  }
  Calendar() = default;

  [[gnu::always_inline]] void push(double time, std::uint32_t slot) {
    std::int64_t bucket = bucket_of(time);
    if (bucket < bucket_) bucket = bucket_;  // at a time already passed by rounding
    const std::int64_t windows_ahead = (bucket >> fine_bits_) - (bucket_ >> fine_bits_);
    if (windows_ahead == 0)
      enter(bucket, time, slot, true);
    else
      append(windows_ahead <= static_cast<std::int64_t>(ring_mask_) ? (bucket >> fine_bits_) & ring_mask_ : beyond(),
             time, slot);
  }

  /// Takes out and returns the slot whose event is the earliest and not after `limit`; no_disk if there is none.
  /// `before(a, b)` orders two slots whose events are at the same time; `ahead(slot)` and `soon(slot)` are told whose
  /// events come about ten and five buckets later.
  template <class Before, class Ahead, class Soon>
  [[gnu::always_inline]] std::uint32_t pop(const Record* records, double limit, Before&& before, Ahead&& ahead,
                                           Soon&& soon) {
    for (;;) {
      Line& line = lines_[bucket_ & fine_mask_];
      auto [soonest, lanes] = smallest_of_8(line.time);
      if (line.more != 0) [[unlikely]] {  // rare: the bucket has several lines
        const Place place = earliest_of_lines(records, before);
        if (place.time < nothing) {
          if (place.time > limit) return no_disk;
          lines_[place.line].time[place.lane] = nothing;
          return lines_[place.line].slot[place.lane];
        }
        line = Line();
        soonest = nothing;
      }
      if (soonest == nothing) {
        line.count = 0;
        if (bucket_ >= bucket_of(limit)) return no_disk;
        open_next_bucket(records, ahead, soon);
        continue;
      }
      if (soonest > limit) return no_disk;
      auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
      if ((lanes & (lanes - 1)) != 0) lane = first_of_ties(line, lanes, records, before);
      line.time[lane] = nothing;
      const std::uint32_t slot = line.slot[lane];
      if (states(records[slot], soonest)) [[likely]]
        return slot;
    }
  }

  [[nodiscard]] std::size_t bytes() const {
    return lines_.capacity_bytes() + chains_.bytes() + chunks_.capacity_bytes();
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr std::int64_t ahead_buckets = 10, soon_buckets = 5;
  static constexpr double nothing = std::numeric_limits<double>::infinity();

  /// Entries of a fine bucket of the open window; lanes without one hold the time `nothing`.
  struct alignas(64) Line {
    double time[8] = {nothing, nothing, nothing, nothing, nothing, nothing, nothing, nothing};
    std::uint32_t slot[8] = {};
    std::uint32_t count = 0;  // lanes used since the bucket was empty
    std::uint32_t more = 0;   // index of the bucket's next line, or 0
  };

  /// A run of entries of one later window. Packed, and how far it is full stands elsewhere (chains_): appending writes
  /// to it without waiting for it.
  struct alignas(64) Chunk {
    static constexpr std::uint32_t capacity = 21, entry_bytes = 12;
    std::uint32_t next;  // the chunk filled before, or none
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
  static_assert(sizeof(Chunk) == 256);

  /// The end of a chain: its last chunk and how many entries that holds; a chain without chunks is "full".
  static constexpr std::uint32_t no_chunks = none << 5 | Chunk::capacity;
  static std::uint32_t chunk_of(std::uint32_t end) { return end >> 5 == none >> 5 ? none : end >> 5; }
  static std::uint32_t count_of(std::uint32_t end) { return end & 31; }

  struct Place {
    double time = nothing;
    std::size_t line = 0, lane = 0;
  };

  [[gnu::always_inline]] std::int64_t bucket_of(double time) const {
    const double bucket = (time - start_) * inverse_width_;
    return static_cast<std::int64_t>(bucket < 0x1p52 ? bucket : 0x1p52);  // from 2^52 on: never
  }

  /// Whether an entry counts. An entry's time is a copy: comparing bits spares a branch for NaN.
  [[gnu::always_inline]] static bool states(const Record& disk, double time) {
    return std::bit_cast<std::uint64_t>(disk.next_time) == std::bit_cast<std::uint64_t>(time);
  }

  /// The chain of what lies more than a turn of the ring ahead.
  [[nodiscard]] std::uint64_t beyond() const { return ring_mask_ + 1; }

  /// Into a fine bucket, if `valid`; without a branch, since that cannot be foretold.
  [[gnu::always_inline]] void enter(std::int64_t bucket, double time, std::uint32_t slot, bool valid) {
    Line& line = lines_[bucket & fine_mask_];
    if (line.count == 8) [[unlikely]] {
      if (valid) enter_full(bucket & fine_mask_, time, slot);
      return;
    }
    const auto bits = std::bit_cast<std::uint64_t>(time), no_bits = std::bit_cast<std::uint64_t>(nothing);
    line.time[line.count] = std::bit_cast<double>(bits ^ ((bits ^ no_bits) & (std::uint64_t{valid} - 1)));
    line.slot[line.count] = slot;
    line.count += valid;
  }

  /// Into the first lane that is free, or has become so, of the lines of a bucket.
  [[gnu::noinline]] void enter_full(std::size_t index, double time, std::uint32_t slot) {
    for (;; index = lines_[index].more) {
      Line& line = lines_[index];
      for (std::size_t lane = 0; lane < 8; ++lane) {
        if (line.time[lane] < nothing) continue;
        line.time[lane] = time;
        line.slot[lane] = slot;
        return;
      }
      if (line.more == 0) {
        const auto more = static_cast<std::uint32_t>(lines_.size());
        lines_.push_back(Line());
        lines_[index].more = more;
      }
    }
  }

  /// Of entries at the same time, the first in order. Most often they are one entry twice (a disk may have found again
  /// and again that its kick comes next): all but one are struck out.
  template <class Before>
  [[gnu::always_inline]] unsigned first_of_ties(Line& line, unsigned lanes, const Record* records,
                                                Before&& before) const {
    auto best = static_cast<unsigned>(__builtin_ctz(lanes));
    while ((lanes &= lanes - 1) != 0) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
      const std::uint32_t slot = line.slot[lane];
      if (slot == line.slot[best])
        line.time[lane] = nothing;
      else if (const double time = line.time[lane]; states(records[slot], time))
        if (!states(records[line.slot[best]], time) || before(slot, line.slot[best])) best = lane;
    }
    return best;
  }

  template <class Before>
  [[gnu::noinline]] Place earliest_of_lines(const Record* records, Before&& before) {
    Place best;
    std::size_t index = bucket_ & fine_mask_;
    do {
      const Line& line = lines_[index];
      for (std::size_t lane = 0; lane < 8; ++lane) {
        const double time = line.time[lane];
        const bool valid = time < nothing && states(records[line.slot[lane]], time);
        if (!valid) continue;
        if (time < best.time || (time == best.time && before(line.slot[lane], lines_[best.line].slot[best.lane])))
          best = {time, index, lane};
      }
      index = line.more;
    } while (index != 0);
    return best;
  }

  [[gnu::always_inline]] void append(std::uint64_t chain, double time, std::uint32_t slot) {
    std::uint32_t& end = chains_[chain];
    if (count_of(end) == Chunk::capacity) [[unlikely]]
      end = new_chunk(chunk_of(end)) << 5;
    chunks_[end >> 5].write(count_of(end), time, slot);
    ++end;
  }

  [[gnu::noinline]] std::uint32_t new_chunk(std::uint32_t next) {
    std::uint32_t chunk = free_;
    if (chunk != none) {
      free_ = chunks_[chunk].next;
    } else {
      chunk = static_cast<std::uint32_t>(chunks_.size());
      chunks_.push_back({});
    }
    chunks_[chunk].next = next;
    return chunk;
  }

  /// Takes a whole chain and calls visit(time, slot) with its entries.
  template <class Visit>
  void empty_chain(std::uint64_t chain, Visit&& visit) {
    const std::uint32_t end = std::exchange(chains_[chain], no_chunks);
    std::uint32_t current = chunk_of(end);
    for (std::uint32_t count = count_of(end); current != none; count = Chunk::capacity) {
      for (std::uint32_t i = 0; i < count; ++i)  // visiting may move the chunks
        visit(chunks_[current].time(i), chunks_[current].slot(i));
      const std::uint32_t next = chunks_[current].next;
      chunks_[current].next = free_;
      free_ = current;
      current = next;
    }
  }

  template <class Ahead, class Soon>
  [[gnu::always_inline]] void open_next_bucket(const Record* records, Ahead&& ahead, Soon&& soon) {
    ++bucket_;
    if ((bucket_ & fine_mask_) == 0) [[unlikely]] {
      open_window(records);
      for (std::int64_t i = 0; i < ahead_buckets && i < static_cast<std::int64_t>(fine_mask_); ++i)
        visit_bucket(bucket_ + i, ahead);
      for (std::int64_t i = 0; i < soon_buckets && i < static_cast<std::int64_t>(fine_mask_); ++i)
        visit_bucket(bucket_ + i, soon);
    }
    if (!out_of_cache_) return;
    visit_bucket(bucket_ + ahead_buckets, ahead);
    visit_bucket(bucket_ + soon_buckets, soon);
    fetch_next_window(records);
  }

  /// A few entries at a time, brings the records nearer that opening the next window will read.
  [[gnu::always_inline]] void fetch_next_window(const Record* records) {
    for (int n = 0; n < 4; ++n) {
      const std::uint32_t chunk = chunk_of(fetching_);
      if (chunk == none) return;
      if (count_of(fetching_) > 0) {
        --fetching_;
        prefetch(&records[chunks_[chunk].slot(count_of(fetching_))]);
      } else {
        const std::uint32_t next = chunks_[chunk].next;
        fetching_ = next == none ? no_chunks : next << 5 | Chunk::capacity;
      }
    }
  }

  /// Calls visit(slot) for the entries in the first line of a bucket, if that is in the open window.
  template <class Visit>
  [[gnu::always_inline]] void visit_bucket(std::int64_t bucket, Visit&& visit) const {
    const Line& line = lines_[bucket & fine_mask_];
    for (std::uint32_t lane = 0; lane < line.count; ++lane) visit(line.slot[lane]);
  }

  [[gnu::noinline]] void open_window(const Record* records) {
    lines_.shrink(fine_mask_ + 1);
    const std::uint64_t window = bucket_ >> fine_bits_ & ring_mask_;
    if (window == 0)
      empty_chain(beyond(), [&](double time, std::uint32_t slot) {
        if (states(records[slot], time)) push(time, slot);
      });
    empty_chain(window, [&](double time, std::uint32_t slot) {
      enter(bucket_of(time), time, slot, states(records[slot], time));
    });
    fetching_ = chains_[(window + 1) & ring_mask_];
  }

  double start_ = 0, inverse_width_ = 1;
  bool out_of_cache_ = false;                    // whether fetching ahead pays
  unsigned fine_bits_ = 4;                       // a window has 2^fine_bits_ fine buckets
  std::uint64_t fine_mask_ = 0, ring_mask_ = 0;  // number of fine buckets in a window, of windows in the ring; less 1
  std::int64_t bucket_ = 0;                      // the open fine bucket, counted from start_
  GrowingArray<Line> lines_;                     // the fine buckets of the open window; then second lines
  Array<std::uint32_t> chains_;                  // the ring of windows, then beyond(): where each ends
  std::uint32_t free_ = none;                    // chain of unused chunks
  GrowingArray<Chunk> chunks_;
  std::uint32_t fetching_ = no_chunks;  // where fetch_next_window has come to
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
