#include <cerrno>
#include <ctime>
#include <offnominal/realtime/cycle_timer.hpp>

namespace offnominal::realtime {

Microseconds monotonic_us() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return Microseconds{now.tv_sec} * kSecond + now.tv_nsec / 1000;
}

void sleep_until_us(Microseconds time_us) {
  const timespec until{.tv_sec = static_cast<time_t>(time_us / kSecond),
                       .tv_nsec = static_cast<long>(time_us % kSecond * 1000)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

Tick CycleTimer::wait() {
  if (next_us_ == 0) next_us_ = (monotonic_us() / period_us_ + 1) * period_us_ + phase_us_;
  sleep_until_us(next_us_);
  Tick tick;
  tick.begin_us = monotonic_us();
  const Microseconds missed = (tick.begin_us - next_us_) / period_us_;
  tick.late_ticks = static_cast<std::uint32_t>(missed);
  tick.latency_us = tick.begin_us - next_us_ - missed * period_us_;
  next_us_ += (missed + 1) * period_us_;
  return tick;
}

}  // namespace offnominal::realtime
