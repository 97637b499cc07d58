// What the simulation asks of anything that measures it.
#pragma once

#include <concepts>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/core/frame.h"

namespace sandglass {

/// An Observer names the next physical time it wants to see (infinity when it has seen enough), is shown the frame of
/// exactly that time, can be merged with another of its kind that saw the same plan on an independent run, lists its
/// fields once (for checkpoints), and turns them into datasets. It changes nothing in the simulation.
template <class T>
concept Observer = requires(T observer, const T& constant, const Frame& frame) {
  { constant.next_sample() } -> std::convertible_to<double>;
  observer.sample(frame);
  observer.merge(constant);
  { observer.fields() } -> std::convertible_to<std::vector<Field>>;
  { constant.results() } -> std::convertible_to<std::vector<Dataset>>;
};

/// Advances `engine` to physical time `end`, showing each observer its frames on the way. Samples due exactly at `end`
/// are taken. `Engine` is Simulation or Reference.
template <class Engine, Observer... Observers>
void run_until(Engine& engine, double end, Frame& frame, Observers&... observers) {
  for (;;) {
    double next = end;
    ((next = observers.next_sample() < next ? observers.next_sample() : next), ...);
    engine.run_until(next);
    bool made = false;
    auto show = [&](auto& observer) {
      if (observer.next_sample() > next) return;
      if (!made) engine.make_frame(frame), made = true;
      observer.sample(frame);
    };
    (show(observers), ...);
    if (next >= end) return;
  }
}

}  // namespace sandglass
