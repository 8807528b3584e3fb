#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wcet/cyclic.hpp"
#include "wcet/cyclictest.hpp"
#include "wcet/extreme_value.hpp"
#include "wcet/histogram.hpp"
#include "wcet/machine.hpp"
#include "wcet/scenario.hpp"
#include "wcet/search.hpp"
#include "wcet/tick.hpp"

// The measurement: search for the costliest beginning of a tick, then time that tick many times.

namespace offnominal::desk::wcet {

inline constexpr std::int64_t kMostTicks = 100'000'000;

struct WcetSettings {
  std::int64_t ticks = 1'000'000;          // of the worst input, warm cache; 1 to kMostTicks
  std::optional<std::int64_t> cold_ticks;  // none: a thousandth of ticks, 100 to 10 000
  std::optional<double> period_s;          // none: the robot's
  SearchSettings search;
  double exceedance = 1e-9;  // per tick, of the extrapolated bound
  Precision precision = Precision::kFloat;
  hal::FrameFormat format = hal::FrameFormat::kClassic;
  MachineRequest machine;
  bool compare_cyclictest = false;
  std::int64_t cyclic_ticks = 10'000;  // of that comparison
};

/// Durations of one kind of tick.
struct Timing {
  Histogram histogram;
  std::uint64_t overruns = 0;  // longer than the period
};

struct ScenarioTiming {
  std::string name;
  std::string words;
  TickFacts facts;
  Timing timing;
};

struct PhaseTiming {
  std::string name;
  Histogram histogram;
};

/// What lies beyond the measurement, under assumptions.
struct Extrapolation {
  std::int64_t block_size = 0;
  std::size_t blocks = 0;
  std::optional<GumbelFit> fit;  // of the largest durations of the blocks, ns
  double kolmogorov = 0;         // fits where below kKolmogorovLimit
  double exceedance = 0;         // per tick
  double bound_ns = 0;           // exceeded with that probability, if the fit holds
  [[nodiscard]] bool holds() const { return fit && kolmogorov <= kKolmogorovLimit; }
};

struct Comparison {
  CyclicResult tick;  // woken every period, with the worst input
  CyclictestResult cyclictest;
  std::int64_t interval_us = 0;
};

struct WcetResult {
  std::string robot;
  int joints = 0;
  int hidden_units = 0;
  int hidden_capacity = 0;  // that are computed
  Precision precision = Precision::kFloat;
  double period_s = 0;
  std::uint64_t seed = 0;
  int evaluations = 0;
  Machine machine;
  std::vector<std::string> refused;  // what the kernel did not grant
  Interference interference;         // during the measurement of `worst`
  std::int64_t clock_ns = 0;  // what reading the clock once more costs; it is in every duration
  std::vector<ScenarioTiming> scenarios;
  std::vector<PhaseTiming> phases;
  TickInput worst_input;
  TickFacts worst_facts;
  std::string worst_from;  // "search", or the name of the scenario
  Timing worst;            // warm cache
  Timing cold;
  std::string cold_method;
  Extrapolation extrapolation;
  std::optional<Comparison> comparison;
};

/// Called now and then, never while a tick is timed.
using OnWcetProgress = std::function<void(const std::string& what, std::int64_t done)>;

/// Throws InputError as make_tick() and run_cyclictest() do.
[[nodiscard]] WcetResult measure_wcet(const RobotDescription& robot, const WcetSettings& settings,
                                      const OnWcetProgress& on_progress);

}  // namespace offnominal::desk::wcet
