#pragma once

#include <string>

namespace offnominal::realtime {

// What a thread needs for its cycle to be on time.
struct Wish {
  int priority = 80;                                      // of SCHED_FIFO, 1 to 99; 0: do not ask
  bool lock_memory = true;                                // mlockall(), of the whole process
  static constexpr std::size_t kStackBytes = 256 * 1024;  // touched before the first tick
};

// What it got. An errno where it was refused.
struct Grant {
  bool fifo = false;
  bool locked = false;
  int fifo_error = 0;
  int lock_error = 0;
  int priority = 0;
};

// For the calling thread, before its first tick. What is refused is left as it is. The heap may be
// used here, not afterwards.
[[nodiscard]] Grant ask_for(const Wish& wish);

// "SCHED_FIFO 80, memory locked, 256 KiB of stack touched", or what was refused and what would
// allow it.
[[nodiscard]] std::string words_of(const Grant& grant);

}  // namespace offnominal::realtime
