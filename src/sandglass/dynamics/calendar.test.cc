#include "sandglass/dynamics/calendar.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

struct Model {
  Array<Record> records;
  std::uint64_t seed, drawn = 0;

  Model(std::size_t size, std::uint64_t seed_) : records(size), seed(seed_) {
    for (Record& record : records) record.next_time = std::numeric_limits<double>::infinity();
  }
  std::uint64_t any(std::uint64_t below) { return random_words(seed, Stream::probe, 0, ++drawn)[0] % below; }
  [[nodiscard]] std::uint32_t earliest() const {
    std::uint32_t slot = 0;
    for (std::uint32_t i = 1; i < records.size(); ++i)
      if (records[i].next_time < records[slot].next_time) slot = i;
    return slot;
  }
};

}  // namespace

TEST_CASE("a calendar gives the events that count, in order of time and, at one time, of slots") {
  CHECK(rc::check([](std::uint64_t seed, bool out_of_cache) {
    // Many events at one time, most entries stale when their turn comes, and new ones in the open window. More at a
    // time than the calendar looks ahead.
    const auto size = *rc::gen::inRange<std::size_t>(1, 600);
    const auto times = *rc::gen::element<std::uint64_t>(2, 20, 1000);
    const double window = *rc::gen::element(0.01, 1.0, 30.0);
    Model model(size, seed);
    Calendar calendar(0, 1, window, size, out_of_cache);
    auto enter = [&](std::uint32_t slot, double now) {
      const double time = now + 4 * static_cast<double>(model.any(times)) / static_cast<double>(times);
      model.records[slot].next_time = time;
      calendar.push(time, slot);
    };
    auto in_order = [](std::uint32_t a, std::uint32_t b) { return a < b; };
    for (std::uint32_t slot = 0; slot < size; ++slot)
      for (int again = 0; again < 3; ++again) enter(slot, 0);
    for (int event = 0; event < 1500; ++event) {
      const std::uint32_t expected = model.earliest();
      const double now = model.records[expected].next_time;
      RC_ASSERT(calendar.pop(model.records.begin(), std::nextafter(now, -1.0), in_order) == no_disk);
      RC_ASSERT(calendar.pop(model.records.begin(), now, in_order) == expected);
      enter(expected, now + 1e-3);
      const auto other = static_cast<std::uint32_t>(model.any(size));
      if (model.any(3) == 0) enter(other, now);
    }
  }));
}
