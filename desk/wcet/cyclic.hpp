#pragma once

#include <cstdint>
#include <functional>

#include "wcet/histogram.hpp"
#include "wcet/machine.hpp"

namespace offnominal::desk::wcet {

struct CyclicSettings {
  std::int64_t interval_us = 1000;
  std::int64_t ticks = 10'000;
  MachineRequest request;  // what cyclictest is asked to use too
  Machine machine;         // what was granted
};

/// Work that is woken every interval.
struct CyclicResult {
  Histogram latency;           // from the time it was due to its first instruction
  Histogram response;          // from the time it was due to its end
  std::uint64_t overruns = 0;  // responses longer than the interval
};

/// Sleeps until each multiple of the interval, absolute on the monotonic clock, and runs `work`.
/// `between` is called after it, before the next sleep. A wake-up that is late by whole intervals
/// is recorded as it is; the ones that passed meanwhile are left out.
[[nodiscard]] CyclicResult run_cyclic(const CyclicSettings& settings,
                                      const std::function<void()>& work,
                                      const std::function<void()>& between);

}  // namespace offnominal::desk::wcet
