#include "wcet/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace offnominal::desk::wcet {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::max();
// A little inside, because frames round.
constexpr double kInside = 0.999;

double smallest_of(Precision precision) {
  return precision == Precision::kFloat
             ? static_cast<double>(std::numeric_limits<float>::denorm_min())
             : std::numeric_limits<double>::denorm_min();
}

// A position between the limits, as a share of them from -1 to 1.
double position_at(const SampleRange& range, std::size_t joint, double share) {
  const double middle = 0.5 * (range.q_min[joint] + range.q_max[joint]);
  return middle + 0.5 * share * (range.q_max[joint] - range.q_min[joint]);
}

// Everything at this share of its limits, with signs that change from joint to joint.
TickInput sample_at(const SampleRange& range, double share) {
  TickInput input;
  for (std::size_t j = 0; j < range.dq_max.size(); ++j) {
    const double sign = j % 2 == 0 ? 1 : -1;
    input.q.push_back(position_at(range, j, sign * share));
    input.dq.push_back(sign * share * range.dq_max[j]);
    input.tau.push_back(-sign * share * range.tau_max[j]);
  }
  return input;
}

// Uniform between the logarithms.
double drawn_between(double low, double high, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> exponent(std::log(low), std::log(high));
  return std::exp(exponent(generator));
}

}  // namespace

SampleRange sample_range(const RobotDescription& robot) {
  constexpr double kLargestTorque = 1e6;
  SampleRange range;
  for (const RobotJoint& joint : robot.joints) {
    const Joint<double>& limits = joint.joint;
    // The middle stays legal where the limits do not hold 0.
    const double low = std::max(limits.min_position, -kMaxFramePosition);
    const double high = std::min(limits.max_position, kMaxFramePosition);
    const double slack = 0.5 * (1 - kInside) * (high - low);
    range.q_min.push_back(low + slack);
    range.q_max.push_back(high - slack);
    range.dq_max.push_back(kInside * std::min(limits.max_velocity, kMaxFrameVelocity));
    range.tau_max.push_back(kInside * (limits.max_torque < kNoLimit
                                           ? std::min(limits.max_torque, kLargestTorque)
                                           : kLargestTorque));
  }
  return range;
}

std::vector<Scenario> scenarios(const RobotDescription& robot, Precision precision) {
  const SampleRange range = sample_range(robot);
  const double weights = robot.estimator.weight_radius /
                         std::sqrt(robot.estimator.hidden_units * (4.0 * robot.joint_count() + 1));
  TickInput healthy = sample_at(range, 0.02);
  healthy.input_weights = 0.3 * weights;
  healthy.output_weights = 0.3 * weights;
  healthy.ticks = 1000;

  TickInput adapting = healthy;
  adapting.error_to_threshold = 3;
  TickInput ball = adapting;
  ball.on_ball = true;
  TickInput edge = healthy;
  edge.error_to_threshold = 1 + 1e-6;
  TickInput saturated = sample_at(range, 0.9);
  saturated.error_to_threshold = 3;
  saturated.output_weights = 0.1 * weights;
  saturated.pre_activation = 40;
  TickInput subnormal = adapting;
  // Output weights start at 0 and grow by what exceeds the threshold: this small at first.
  subnormal.output_weights = 1000 * smallest_of(precision);
  subnormal.threshold = 1e-3;
  subnormal.error_to_threshold = 1 + 1e-5;
  TickInput largest = sample_at(range, 1);
  largest.threshold = 10;
  largest.error_to_threshold = 100;
  largest.on_ball = true;
  largest.input_weights = weights;
  largest.output_weights = weights;
  largest.ticks = std::numeric_limits<std::uint32_t>::max() - 1;
  TickInput flooded = adapting;
  flooded.foreign_frames = kMostFramesPerTick;

  return {{"healthy", "inside the dead-zone, nothing is learned", healthy},
          {"adapting", "|e| = 3 mu, weights well inside the ball", adapting},
          {"projection_ball", "|theta| = M, learning points outwards", ball},
          {"dead_zone_edge", "|e| above mu by a millionth", edge},
          {"saturated_sigmoids", "every sigmoid at its end", saturated},
          {"subnormals", "output weights below the smallest normal number", subnormal},
          {"largest_values", "the sample at its limits, |e| = 100 mu, on the ball", largest},
          {"flooded_bus", "as adapting, and as many frames as a tick takes", flooded}};
}

TickInput mutated(TickInput input, const RobotDescription& robot, const SampleRange& range,
                  Precision precision, std::mt19937_64& generator) {
  const auto uniform = [&generator](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  const auto whole = [&generator](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(generator);
  };
  const auto joint = static_cast<std::size_t>(whole(0, robot.joint_count() - 1));
  const double radius = robot.estimator.weight_radius;
  for (int change = whole(1, 3); change > 0; --change) {
    switch (whole(0, 8)) {
      case 0:
        input.q[joint] = position_at(range, joint, uniform(-1, 1));
        break;
      case 1:
        input.dq[joint] = whole(0, 3) == 0 ? 0 : uniform(-1, 1) * range.dq_max[joint];
        break;
      case 2:
        input.tau[joint] =
            uniform(-1, 1) * drawn_between(1e-6, 1, generator) * range.tau_max[joint];
        break;
      case 3:
        input.threshold = drawn_between(1e-12, 100, generator);
        break;
      case 4:
        input.error_to_threshold =
            whole(0, 1) == 0 ? 1 + drawn_between(1e-7, 1000, generator) : uniform(0, 1);
        break;
      case 5:
        input.input_weights = drawn_between(1e-6 * radius, radius, generator);
        break;
      case 6:
        input.output_weights = drawn_between(smallest_of(precision), radius, generator);
        break;
      case 7:
        input.pre_activation = whole(0, 2) == 0 ? 0 : drawn_between(0.1, 100, generator);
        input.on_ball = whole(0, 2) == 0;
        break;
      default:
        input.ticks = static_cast<std::uint32_t>(drawn_between(1, 4e9, generator));
        break;
    }
  }
  return input;
}

}  // namespace offnominal::desk::wcet
