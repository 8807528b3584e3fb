#include "robot/doubts_of_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace offnominal::desk {
namespace {

// Axes without cables turn on and on, and their limits are as round in radians. Below, a turn or a
// few is usual; above a turn in degrees nobody writes degrees.
bool look_like_degrees(double low, double high) {
  constexpr double kFew = 30;       // 5 turns of radians
  constexpr double kTurnDeg = 360;  // and a little
  constexpr double kLittle = 1.1;
  constexpr double kRound = 5;
  const double furthest = std::max(std::abs(low), std::abs(high));
  const auto is_round = [](double x) { return std::fmod(x, kRound) == 0; };
  return furthest >= kFew && furthest <= kLittle * kTurnDeg && is_round(low) && is_round(high);
}

}  // namespace

std::vector<std::string> doubts_of_limits(const RobotDescription& robot) {
  std::vector<std::string> doubts;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint<double>& joint = robot.joints[i].joint;
    const double low = joint.min_position;
    const double high = joint.max_position;
    if (joint.type != JointType::kRevolute || !look_like_degrees(low, high)) continue;
    constexpr double kPerDegree = std::numbers::pi / 180;
    doubts.push_back(fmt::format(
        "joint {} ({}): `position` of its [joint.limits], [{:g}, {:g}] rad, is {:.3g} turns from "
        "end to end, and round numbers of degrees; to mend: write [{:.6g}, {:.6g}] where degrees "
        "were "
        "meant, else leave it",
        i + 1, robot.joints[i].name, low, high, (high - low) / (2 * std::numbers::pi),
        kPerDegree * low, kPerDegree * high));
  }
  return doubts;
}

}  // namespace offnominal::desk
