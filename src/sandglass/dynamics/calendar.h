// The event calendar: which disk's event is next, in constant time.
#pragma once

#include <cstdint>

#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/record.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// A lazy two-level bucket calendar. Time is cut into fine buckets of a few events, and into windows of 2^k fine
/// buckets; a ring of 2^k windows lies ahead. An entry of a later window is only appended to that window's chain of
/// chunks; when a window opens, its entries are dealt into fine buckets; when a fine bucket opens, its few entries are
/// searched for the earliest. Nothing is moved or removed when a prediction changes: an entry counts only while it
/// still states its disk's next_time.
class Calendar {
 public:
  /// Fine buckets are `bucket_width` long, counted from time `start`; about `size` entries live at a time.
  Calendar(double start, double bucket_width, std::size_t size) : start_(start), inverse_width_(1 / bucket_width) {
    while (bits_ < 12 && (std::size_t{1} << (2 * bits_)) < size) ++bits_;
    mask_ = (std::uint64_t{1} << bits_) - 1;
    heads_ = Array<std::uint32_t>(mask_ + 1);
    chains_ = Array<std::uint32_t>(mask_ + 2);
    for (std::uint32_t& head : heads_) head = none;
    for (std::uint32_t& chain : chains_) chain = none;
  }
  Calendar() = default;

  [[gnu::always_inline]] void push(double time, std::uint32_t slot) {
    const std::uint64_t bucket = bucket_of(time);
    if (bucket <= bucket_) {
      open_.push_back({time, slot});
      return;
    }
    const std::uint64_t windows_ahead = (bucket >> bits_) - (bucket_ >> bits_);
    if (windows_ahead == 0)
      link(bucket & mask_, time, slot);
    else
      append(windows_ahead <= mask_ ? (bucket >> bits_) & mask_ : beyond(), time, slot);
  }

  /// Takes out and returns the slot whose event is the earliest and not after `limit`; no_disk if there is none.
  /// `before(a, b)` orders two slots whose events are at the same time.
  template <class Before>
  [[gnu::always_inline]] std::uint32_t pop(const Record* records, double limit, Before&& before) {
    for (;;) {
      while (!open_.empty()) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < open_.size(); ++i) {
          if (open_[i].time < open_[best].time) {
            best = i;
          } else if (open_[i].time == open_[best].time) [[unlikely]] {
            if (!valid(records, open_[best]) || (valid(records, open_[i]) && before(open_[i].slot, open_[best].slot)))
              best = i;
          }
        }
        const Entry entry = open_[best];
        if (entry.time > limit) return no_disk;
        open_[best] = open_.back();
        open_.pop_back();
        if (valid(records, entry)) return entry.slot;
      }
      if (bucket_ >= bucket_of(limit)) return no_disk;
      open_next_bucket(records);
    }
  }

  [[nodiscard]] std::size_t bytes() const {
    return heads_.bytes() + chains_.bytes() + nodes_.capacity_bytes() + chunks_.capacity_bytes() +
           open_.capacity_bytes();
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  struct Entry {
    double time;
    std::uint32_t slot;
  };
  struct Node {  // an entry in a fine bucket of the open window
    double time;
    std::uint32_t slot, next;
  };
  struct Chunk {  // a run of entries of one window
    std::uint32_t count, next;
    Entry entries[15];
  };

  [[gnu::always_inline]] std::uint64_t bucket_of(double time) const {
    const double bucket = (time - start_) * inverse_width_;
    // Negative: an event at a time already passed by rounding. From 2^52 on: never.
    if (!(bucket < 0x1p52)) return std::uint64_t{1} << 52;
    return bucket > 0 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(bucket)) : 0;
  }

  [[gnu::always_inline]] static bool valid(const Record* records, const Entry& entry) {
    return records[entry.slot].next_time == entry.time;
  }

  /// The chain of what lies more than a turn of the ring ahead.
  [[nodiscard]] std::uint64_t beyond() const { return mask_ + 1; }

  [[gnu::always_inline]] void link(std::uint64_t head, double time, std::uint32_t slot) {
    nodes_.push_back({time, slot, heads_[head]});
    heads_[head] = static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  [[gnu::always_inline]] void append(std::uint64_t chain, double time, std::uint32_t slot) {
    std::uint32_t& last = chains_[chain];
    if (last == none || chunks_[last].count == 15) [[unlikely]]
      last = new_chunk(last);
    Chunk& chunk = chunks_[last];
    chunk.entries[chunk.count++] = {time, slot};
  }

  std::uint32_t new_chunk(std::uint32_t next) {
    std::uint32_t chunk = free_;
    if (chunk != none) {
      free_ = chunks_[chunk].next;
    } else {
      chunk = static_cast<std::uint32_t>(chunks_.size());
      chunks_.push_back({});
    }
    chunks_[chunk].count = 0;
    chunks_[chunk].next = next;
    return chunk;
  }

  /// Takes a whole chain and pushes what still counts again, now that its time has come nearer.
  void deal(std::uint64_t chain, const Record* records) {
    std::uint32_t current = std::exchange(chains_[chain], none);
    while (current != none) {
      for (std::uint32_t i = 0; i < chunks_[current].count; ++i) {
        const Entry entry = chunks_[current].entries[i];  // a copy: pushing may move the chunks
        if (valid(records, entry)) push(entry.time, entry.slot);
      }
      const std::uint32_t next = chunks_[current].next;
      chunks_[current].next = free_;
      free_ = current;
      current = next;
    }
  }

  void open_next_bucket(const Record* records) {
    ++bucket_;
    if ((bucket_ & mask_) == 0) {
      nodes_.clear();
      if (((bucket_ >> bits_) & mask_) == 0) deal(beyond(), records);
      deal((bucket_ >> bits_) & mask_, records);
    }
    std::uint32_t& head = heads_[bucket_ & mask_];
    for (std::uint32_t node = head; node != none; node = nodes_[node].next)
      open_.push_back({nodes_[node].time, nodes_[node].slot});
    head = none;
  }

  double start_ = 0, inverse_width_ = 1;
  unsigned bits_ = 4;            // a window has 2^bits_ fine buckets, the ring 2^bits_ windows
  std::uint64_t mask_ = 0;       // 2^bits_ - 1
  std::uint64_t bucket_ = 0;     // the open fine bucket, counted from start_
  Array<std::uint32_t> heads_;   // fine buckets of the open window: chains of nodes
  Array<std::uint32_t> chains_;  // the ring of windows, then beyond(): chains of chunks
  std::uint32_t free_ = none;    // chain of unused chunks
  GrowingArray<Node> nodes_;
  GrowingArray<Chunk> chunks_;
  GrowingArray<Entry> open_;  // the open fine bucket
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
