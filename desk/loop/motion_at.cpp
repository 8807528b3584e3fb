#include "loop/motion_at.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "offnominal/sim/trajectory.hpp"

namespace offnominal::desk {
namespace {

// rest + size (1 - cos(speed t)) / 2
struct Sway {
  double rest = 0;
  double size = 0;
  double speed = 0;  // rad/s of the cosine
};

Sway sway_of(const Joint<double>& joint, int number) {
  constexpr double kFar = 1e3;  // beyond it there is no limit
  const double lowest = std::max(joint.min_position, -kFar);
  const double highest = std::min(joint.max_position, kFar);
  const bool turns = joint.type == JointType::kRevolute;
  Sway sway;
  sway.size = std::min(turns ? 0.2 : 0.05, 0.1 * (highest - lowest));
  const bool around_zero = lowest < -sway.size && highest > 2 * sway.size;
  sway.rest = around_zero ? 0 : (lowest + highest) / 2;
  // No two joints alike, and at a quarter of the joint's velocity at most: size speed / 2.
  sway.speed = std::min(2.0 + 0.3 * number, 0.5 * joint.max_velocity / sway.size);
  return sway;
}

}  // namespace

MotionAt paper_motion() { return sim::paper_trajectory; }

MotionAt sway_of(const RobotDescription& robot) {
  std::vector<Sway> sways;
  for (const RobotJoint& joint : robot.joints) {
    sways.push_back(sway_of(joint.joint, static_cast<int>(sways.size())));
  }
  return [sways = std::move(sways)](double time_s) {
    const auto joints = static_cast<Eigen::Index>(sways.size());
    sim::DesiredMotion desired;
    for (sim::JointVector* all : {&desired.q, &desired.dq, &desired.ddq}) all->resize(joints);
    for (Eigen::Index i = 0; i < joints; ++i) {
      const Sway& sway = sways[static_cast<std::size_t>(i)];
      const double half = sway.size / 2;
      const double angle = sway.speed * time_s;
      desired.q[i] = sway.rest + half * (1 - std::cos(angle));
      desired.dq[i] = half * sway.speed * std::sin(angle);
      desired.ddq[i] = half * sway.speed * sway.speed * std::cos(angle);
    }
    return desired;
  };
}

MotionAt motion_of(std::shared_ptr<const paper::RecordedMotion> recorded) {
  return [recorded = std::move(recorded)](double time_s) {
    // As it begins and not as it stands before: it may begin on the move.
    return recorded->at(std::max(time_s, std::numeric_limits<double>::min()));
  };
}

MotionAt motion_named(const std::string& name, const RobotDescription& robot) {
  if (name == "sway") return sway_of(robot);
  const int joints = robot.joint_count();
  if (name != "paper") {
    return motion_of(
        std::make_shared<paper::RecordedMotion>(paper::RecordedMotion::read(name, joints)));
  }
  if (joints == 2) return paper_motion();
  throw InputError({"--motion", "", "paper, for " + std::to_string(joints) + " joint(s)",
                    "sway, or a CSV file", "the paper's motion is one of two joints"});
}

}  // namespace offnominal::desk
