#include "loop/refusal_words.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace offnominal::desk {
namespace {

template <typename Misses>
std::string joints_that(const RobotDescription& robot, const Misses& misses) {
  std::vector<std::string> joints;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const RobotJoint& joint = robot.joints[i];
    if (misses(joint)) joints.push_back(fmt::format("{} ({})", i + 1, joint.name));
  }
  return fmt::format("joint {}", fmt::join(joints, ", "));
}

}  // namespace

std::string mend_of(controller::Fault refusal, const RobotDescription& robot) {
  using controller::Fault;
  if (refusal == Fault::kNoGains) {
    const auto misses = [](const RobotJoint& joint) { return joint.kp <= 0 || joint.kd <= 0; };
    return joints_that(robot, misses) +
           ": give kp_per_s2 and kd_per_s in [joint.control] of the robot file "
           "(docs/robot-file.md)";
  }
  if (refusal == Fault::kNoTorqueLimit) {
    // As large as a float can say is none: that is what the controller computes in.
    const auto misses = [](const RobotJoint& joint) {
      return !(joint.joint.max_torque < static_cast<double>(std::numeric_limits<float>::max()));
    };
    return joints_that(robot, misses) +
           ": give `torque` in [joint.limits] of the robot file (docs/robot-file.md)";
  }
  return "docs/troubleshooting.md says what it asks for";
}

}  // namespace offnominal::desk
