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

/// How many threads `numbers` of data are worth: one where there are fewer than `many`, all where
/// there are so many that to begin a thread costs nothing beside them.
[[nodiscard]] inline int threads_for(std::ptrdiff_t numbers, std::ptrdiff_t many = 2'000'000) {
  return numbers < many ? 1 : all_threads();
}

namespace detail {

// Whether this thread works for a loop that several share: all are busy then.
inline bool& shares_a_loop() {
  thread_local bool shares = false;
  return shares;
}

// While it lives, this thread works for such a loop.
class SharedLoop {
 public:
  SharedLoop() { shares_a_loop() = true; }
  ~SharedLoop() { shares_a_loop() = before_; }
  SharedLoop(const SharedLoop&) = delete;
  SharedLoop& operator=(const SharedLoop&) = delete;
  SharedLoop(SharedLoop&&) = delete;
  SharedLoop& operator=(SharedLoop&&) = delete;

 private:
  bool before_ = shares_a_loop();
};

}  // namespace detail

/// Calls work(i) for i = 0 .. count-1 on `threads` threads until one throws: that exception is
/// thrown again, and what had not begun is left. Every call has to write to a place of its own, or
/// to lock, so that results do not depend on the number of threads. A loop within a call of one
/// that several threads share runs on its caller's: the others have work.
template <typename Work>
void parallel_for(std::size_t count, int threads, const Work& work) {
  if (count < 2 || threads < 2 || detail::shares_a_loop()) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto run = [&] {
    const detail::SharedLoop shared;
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
  const auto helpers = std::min(count, static_cast<std::size_t>(threads));
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < helpers; ++i) others.emplace_back(run);
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

/// Calls work(first, size) for parts of 0 .. count-1, each but the last of `size` `most`.
template <typename Work>
void parallel_parts(std::ptrdiff_t count, std::ptrdiff_t most, int threads, const Work& work) {
  parallel_for(static_cast<std::size_t>((count + most - 1) / most), threads, [&](std::size_t i) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(i) * most;
    work(first, std::min(most, count - first));
  });
}

/// Calls work(column) for every column of a recording's `values` (or of what has as many), side by
/// side where they are long; each writes to a place of its own.
template <typename Values, typename Work>
void for_every_column(const Values& values, const Work& work) {
  parallel_for(static_cast<std::size_t>(values.cols()), threads_for(values.size()),
               [&](std::size_t i) { work(static_cast<std::ptrdiff_t>(i)); });
}

}  // namespace offnominal::desk
