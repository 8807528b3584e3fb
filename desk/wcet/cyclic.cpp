#include "wcet/cyclic.hpp"

#include <cerrno>
#include <ctime>

namespace offnominal::desk::wcet {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kNsPerSecond + now.tv_nsec;
}

void sleep_until(std::int64_t due_ns) {
  const timespec due{static_cast<std::time_t>(due_ns / kNsPerSecond),
                     static_cast<long>(due_ns % kNsPerSecond)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
}

}  // namespace

CyclicResult run_cyclic(const CyclicSettings& settings, const std::function<void()>& work,
                        const std::function<void()>& between) {
  CyclicResult result;
  const std::int64_t interval_ns = settings.interval_us * 1000;
  std::int64_t due_ns = monotonic_ns() + interval_ns;
  for (std::int64_t i = 0; i < settings.ticks; ++i) {
    sleep_until(due_ns);
    const std::int64_t begin_ns = monotonic_ns();
    work();
    const std::int64_t end_ns = monotonic_ns();
    result.latency.record(begin_ns - due_ns);
    result.response.record(end_ns - due_ns);
    if (end_ns - due_ns > interval_ns) ++result.overruns;
    between();
    const std::int64_t passed = (monotonic_ns() - due_ns) / interval_ns;
    due_ns += (passed + 1) * interval_ns;
  }
  return result;
}

}  // namespace offnominal::desk::wcet
