// Memory for the engine's tables: fixed size, on huge pages where the system has them.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <utility>

#ifndef SANDGLASS_ISA
#define SANDGLASS_ISA baseline
#endif

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// A zero-initialised block of `size` trivial elements straight from the system. The tables are walked in random
/// order, where every small page would cost a miss of the translation buffer.
template <class T>
class Array {
 public:
  Array() = default;
  explicit Array(std::size_t size) : size_(size) {
    if (size == 0) return;
    constexpr std::size_t huge_page = std::size_t{2} << 20;
    void* memory = ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    if (bytes() >= huge_page) ::madvise(memory, bytes(), MADV_HUGEPAGE);
    data_ = static_cast<T*>(memory);
  }
  Array(Array&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Array& operator=(Array&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~Array() {
    if (data_) ::munmap(data_, bytes());
  }

  [[gnu::always_inline]] T& operator[](std::size_t i) { return data_[i]; }
  [[gnu::always_inline]] const T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const { return size_ * sizeof(T); }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }

  /// Makes room for `size` elements; what is there stays.
  [[gnu::noinline]] void enlarge(std::size_t size) {
    Array larger(size);
    for (std::size_t i = 0; i < size_; ++i) larger[i] = data_[i];
    *this = std::move(larger);
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Brings a cache line nearer to the processor.
[[gnu::always_inline]] inline void prefetch(const void* line) {
  __builtin_prefetch(line);
  asm volatile("");  // or the compiler takes a function that only does this for one that does nothing
}

/// An Array that grows: push_back and clear, capacity kept.
template <class T>
class GrowingArray {
 public:
  GrowingArray() = default;
  explicit GrowingArray(std::size_t size) : storage_(size), size_(size) {}

  void reserve(std::size_t size) {
    if (size > storage_.size()) storage_.enlarge(size);
  }

  [[gnu::always_inline]] void push_back(const T& value) {
    if (size_ == storage_.size()) [[unlikely]]
      grow();
    storage_[size_++] = value;
  }
  void pop_back() { --size_; }
  void clear() { size_ = 0; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[gnu::always_inline]] T& operator[](std::size_t i) { return storage_[i]; }
  [[gnu::always_inline]] const T& operator[](std::size_t i) const { return storage_[i]; }
  T* begin() { return storage_.begin(); }
  T* end() { return storage_.begin() + size_; }
  [[nodiscard]] const T* begin() const { return storage_.begin(); }
  [[nodiscard]] const T* end() const { return storage_.begin() + size_; }

 private:
  void grow() { storage_.enlarge(size_ < 64 ? 64 : size_ + size_ / 2); }

  Array<T> storage_;
  std::size_t size_ = 0;
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
