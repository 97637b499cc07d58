#include "sandglass/dynamics/crew.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace sandglass {

struct Crew::Threads {
  std::mutex mutex;
  std::condition_variable begun, done;
  std::uint64_t round = 0;  // pieces of work so far
  unsigned count = 0, busy = 0;
  Call call = nullptr;
  void* context = nullptr;
  bool over = false;
  std::vector<std::exception_ptr> errors;
  std::vector<std::jthread> others;  // the caller is thread 0

  void perform(unsigned thread) {
    try {
      call(context, thread);
    } catch (...) {
      errors[thread] = std::current_exception();
    }
  }

  // Hints for a glance before going to sleep; what is so is decided under the mutex.
  std::atomic<std::uint64_t> announced{0};
  std::atomic<unsigned> unfinished{0};

  /// Waits a moment for `come`, giving way to others. Most often all end at nearly the same time, and being woken takes
  /// longer than that.
  template <class Come>
  static void watch_briefly(Come&& come) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(50);
    while (!come() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  }

  void live(unsigned thread) {
    std::uint64_t seen = 0;
    for (;;) {
      watch_briefly([&] { return announced.load(std::memory_order_relaxed) != seen; });
      std::unique_lock lock(mutex);
      begun.wait(lock, [&] { return over || (round != seen && thread < count); });
      if (over) return;
      seen = round;
      lock.unlock();
      perform(thread);
      unfinished.fetch_sub(1, std::memory_order_relaxed);
      lock.lock();
      if (--busy == 0) done.notify_one();
    }
  }
};

Crew::Crew(unsigned threads) : threads_(std::make_unique<Threads>()) {
  threads_->errors.resize(threads);
  for (unsigned thread = 1; thread < threads; ++thread)
    threads_->others.emplace_back([all = threads_.get(), thread] { all->live(thread); });
}

Crew::~Crew() {
  const std::scoped_lock lock(threads_->mutex);
  threads_->over = true;
  threads_->begun.notify_all();
}

unsigned Crew::size() const { return static_cast<unsigned>(threads_->errors.size()); }

void Crew::run(unsigned count, Call call, void* context) {
  Threads& all = *threads_;
  {
    const std::scoped_lock lock(all.mutex);
    ++all.round;
    all.count = count;
    all.busy = count - 1;
    all.call = call;
    all.context = context;
    all.unfinished = count - 1;
    all.announced = all.round;
  }
  all.begun.notify_all();
  all.perform(0);
  Threads::watch_briefly([&] { return all.unfinished.load(std::memory_order_relaxed) == 0; });
  std::unique_lock lock(all.mutex);
  all.done.wait(lock, [&] { return all.busy == 0; });
  std::exception_ptr first;
  for (std::exception_ptr& error : all.errors)
    if (std::exception_ptr thrown = std::exchange(error, nullptr); thrown && !first) first = thrown;
  if (first) std::rethrow_exception(first);
}

}  // namespace sandglass
