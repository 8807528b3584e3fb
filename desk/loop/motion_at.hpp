// Where the joints of a run should be.
#pragma once

#include <functional>
#include <memory>
#include <offnominal/control/computed_torque.hpp>
#include <string>

#include "offnominal/sim/joint_state.hpp"
#include "paper/recorded_motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// At a time since arming, s, from 0 on. No heap where it is called.
using MotionAt = std::function<sim::DesiredMotion(double time_s)>;

/// The paper's, of two joints.
[[nodiscard]] MotionAt paper_motion();

/// Every joint to and fro between its rest and a place beside it, smoothly and each in its own
/// time, from rest on: small and slow enough for the position and velocity limits of the robot. Its
/// rest is 0, or the middle of its range where 0 is none of it.
[[nodiscard]] MotionAt sway_of(const RobotDescription& robot);

/// As a file has it; on the move from the first instant where the file is.
[[nodiscard]] MotionAt motion_of(std::shared_ptr<const paper::RecordedMotion> recorded);

/// Of "paper", "sway", or else the file of that name, for a robot of as many joints. Throws
/// InputError where it is none.
[[nodiscard]] MotionAt motion_named(const std::string& name, const RobotDescription& robot);

template <typename Scalar>
[[nodiscard]] Reference<kRuntimeJoints, Scalar> reference_of(const sim::DesiredMotion& desired) {
  return {desired.q.template cast<Scalar>(), desired.dq.template cast<Scalar>(),
          desired.ddq.template cast<Scalar>()};
}

}  // namespace offnominal::desk
