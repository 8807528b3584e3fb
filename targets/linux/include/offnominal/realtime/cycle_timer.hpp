#pragma once

#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>

namespace offnominal::realtime {

using hal::Microseconds;

inline constexpr Microseconds kSecond = 1'000'000;

// One tick that has begun.
struct Tick {
  Microseconds begin_us = 0;     // CLOCK_MONOTONIC
  Microseconds latency_us = 0;   // since the time at which it should have begun; < period
  std::uint32_t late_ticks = 0;  // whole periods that were missed before it
};

// Ticks at k * period + phase of CLOCK_MONOTONIC, k whole: two programs of one machine that have
// the same period keep their distance. Sleeps to absolute times, so that nothing adds up.
class CycleTimer {
 public:
  // period_us > 0; 0 <= phase_us < period_us. The first tick is the next that is due when wait() is
  // first called.
  explicit CycleTimer(Microseconds period_us, Microseconds phase_us = 0)
      : period_us_(period_us), phase_us_(phase_us) {}

  // Sleeps until the next tick. Ticks whose time has passed altogether are left out and counted;
  // none is made up for.
  [[nodiscard]] Tick wait();
  [[nodiscard]] Microseconds period_us() const { return period_us_; }

 private:
  Microseconds period_us_;
  Microseconds phase_us_;
  Microseconds next_us_ = 0;  // 0: none yet
};

[[nodiscard]] Microseconds monotonic_us();

// Nothing before it, and signals do not shorten it.
void sleep_until_us(Microseconds time_us);

}  // namespace offnominal::realtime
