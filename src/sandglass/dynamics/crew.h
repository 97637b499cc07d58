// A few threads that do one piece of work together.
#pragma once

#include <memory>

namespace sandglass {

/// Threads wait asleep between one piece of work and the next, after watching for it for a moment.
class Crew {
 public:
  explicit Crew(unsigned threads);
  ~Crew();

  [[nodiscard]] unsigned size() const;

  /// Calls task(0) ... task(count - 1), each on a thread of its own, and returns when all are done; count <= size().
  /// Throws what one of them has thrown.
  template <class Task>
  [[gnu::always_inline]] void work(unsigned count, Task&& task) {
    run(
        count, [](void* context, unsigned thread) { (*static_cast<Task*>(context))(thread); }, &task);
  }

 private:
  using Call = void (*)(void* context, unsigned thread);
  void run(unsigned count, Call call, void* context);

  struct Threads;
  std::unique_ptr<Threads> threads_;
};

}  // namespace sandglass
