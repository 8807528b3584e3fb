#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wcet/cyclic.hpp"

// cyclictest of the package rt-tests, the yardstick of real-time Linux: how late a thread wakes.

namespace offnominal::desk::wcet {

struct CyclictestResult {
  std::string version;
  std::string command;
  std::int64_t cycles = 0;
  double min_us = 0;
  double mean_us = 0;
  double max_us = 0;
  // Latency in whole us and how often, up to kCyclictestHistogramUs; later wake-ups are not in it.
  std::vector<std::pair<std::int64_t, std::int64_t>> histogram;

  /// Latency that the share p of all wake-ups does not exceed, us; the largest one where that lies
  /// beyond the histogram.
  [[nodiscard]] double quantile_us(double p) const;
};

inline constexpr int kCyclictestHistogramUs = 10'000;

/// The options that give cyclictest what the tick had: interval, number, CPU, scheduler, memory.
[[nodiscard]] std::vector<std::string> cyclictest_arguments(const CyclicSettings& settings,
                                                            const std::string& json_file);

/// What it writes with --json. Throws std::runtime_error for anything else.
[[nodiscard]] CyclictestResult parse_cyclictest(std::string_view json_text);

/// Throws InputError where there is no cyclictest, or it fails.
[[nodiscard]] CyclictestResult run_cyclictest(const CyclicSettings& settings);

}  // namespace offnominal::desk::wcet
