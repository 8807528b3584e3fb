#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace offnominal::desk {

/// As many as the machine runs at once.
[[nodiscard]] inline int all_threads() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

/// How many threads `numbers` of data are worth: one where there are few, all where there are so
/// many that to begin a thread costs nothing beside them.
[[nodiscard]] inline int threads_for(std::ptrdiff_t numbers) {
  constexpr std::ptrdiff_t kMany = 2'000'000;
  return numbers < kMany ? 1 : all_threads();
}

/// Calls work(i) for i = 0 .. count-1 on `threads` threads until one throws: that exception is
/// thrown again, and what had not begun is left. Every call has to write to a place of its own, or
/// to lock, so that results do not depend on the number of threads.
template <typename Work>
void parallel_for(std::size_t count, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(error_mutex);
        if (!error) error = std::current_exception();
        next = count;
      }
    }
  };
  const auto helpers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < helpers; ++i) others.emplace_back(run);
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

}  // namespace offnominal::desk
