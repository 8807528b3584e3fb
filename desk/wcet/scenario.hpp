#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "wcet/tick.hpp"

namespace offnominal::desk::wcet {

/// A kind of tick that may cost more than others.
struct Scenario {
  const char* name;
  const char* words;
  TickInput input;
};

/// What a sample of this robot may be: its limits, or what frames carry; where neither limits a
/// torque, 1e6 N m (N).
struct SampleRange {
  std::vector<double> q_min, q_max;  // rad or m
  std::vector<double> dq_max;        // magnitude, rad/s or m/s
  std::vector<double> tau_max;       // magnitude, N m or N
};
[[nodiscard]] SampleRange sample_range(const RobotDescription& robot);

/// Frames that a tick takes in at most (the controller's own bound).
inline constexpr int kMostFramesPerTick = 256;

/// healthy, adapting, projection_ball, dead_zone_edge, saturated_sigmoids, subnormals,
/// largest_values, flooded_bus.
[[nodiscard]] std::vector<Scenario> scenarios(const RobotDescription& robot, Precision precision);

/// `input` with one to three of its numbers drawn anew or moved: anything that a tick may begin
/// with, on a bus that carries the joints' own frames.
[[nodiscard]] TickInput mutated(TickInput input, const RobotDescription& robot,
                                const SampleRange& range, Precision precision,
                                std::mt19937_64& generator);

}  // namespace offnominal::desk::wcet
