#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion/trajectory.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::motion {

// What a designed motion may use of a joint: the robot file's limits less a margin.
struct JointLimits {
  double low = 0;       // rad or m
  double high = 0;      // rad or m
  double velocity = 0;  // rad/s or m/s
  double torque = 0;    // N m or N, as the model predicts it

  [[nodiscard]] double half_range() const { return (high - low) / 2; }
  [[nodiscard]] double middle() const { return (high + low) / 2; }
};

// `margin`: share of every limit that is left free, 0 <= margin < 1. Throws InputError naming the
// joint where the robot has no limits, since a motion within none cannot be chosen.
std::vector<JointLimits> limits_of(const RobotDescription& robot, double margin);

struct FittedMotion {
  Motion motion;
  Eigen::MatrixXd torque;  // of the robot's model; rows: samples, columns: joints
};

// The plan scaled into the limits at every sample; none where the model cannot even hold the arm at
// the plan's home.
std::optional<FittedMotion> fit_into_limits(const RobotDescription& robot, const MotionPlan& plan,
                                            const std::vector<JointLimits>& limits,
                                            double duration_s, double rate_hz);

}  // namespace offnominal::desk::motion
