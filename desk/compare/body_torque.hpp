#pragma once

#include <Eigen/Core>

#include "compare/motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Whether two robots have the same inverse dynamics, but for their effects.
bool have_same_bodies(const RobotDescription& a, const RobotDescription& b);

// The rigid body's part of a robot's torque over one motion, reflected inertias and point masses
// included: what the links take of it is kept for the next robot, where that has the same. It is
// most of the work of model_torque(), and searches and fits ask for one effect after the other.
class BodyTorque {
 public:
  // N m or N, rows as of the motion; core's rigid_body_torque(), to the bit. `motion`: the same at
  // every call.
  Eigen::MatrixXd of(const RobotDescription& robot, const Motion& motion);

 private:
  RobotDescription links_;  // with the point masses, which are part of them
  Eigen::MatrixXd torque_;  // without reflected inertias; empty: of none yet
};

}  // namespace offnominal::desk
