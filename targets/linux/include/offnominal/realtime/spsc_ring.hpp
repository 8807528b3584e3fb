#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace offnominal::realtime {

// A queue from one thread to one other: neither ever waits for the other, and nothing is allocated.
// Capacity: a power of two. T: plain data.
template <typename T, std::size_t Capacity>
class SpscRing {
  static_assert(Capacity > 0 && (Capacity & (Capacity - 1)) == 0);

 public:
  // By the one thread that fills it. False, and nothing changed, where it is full.
  [[nodiscard]] bool push(const T& item) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Capacity) return false;
    items_[head % Capacity] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  // By the one thread that empties it. False, and nothing changed, where it is empty.
  [[nodiscard]] bool pop(T& item) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    item = items_[tail % Capacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  // On cache lines of their own, so that the two threads do not take them from one another.
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  alignas(kCacheLine) std::array<T, Capacity> items_{};
};

}  // namespace offnominal::realtime
