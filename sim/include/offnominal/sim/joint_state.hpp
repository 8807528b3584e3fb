// What the joints of a plant do, however many there are.
#pragma once

#include <Eigen/Core>
#include <offnominal/joint_count.hpp>

namespace offnominal::sim {

/// One number per joint, 1 to kMaxJoints. No heap.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;

/// Positions, rad or m, and velocities of all joints.
struct JointState {
  JointVector q;
  JointVector dq;
};

/// Where the joints should be, and how fast.
struct DesiredMotion {
  JointVector q;    ///< rad or m
  JointVector dq;   ///< rad/s or m/s
  JointVector ddq;  ///< rad/s^2 or m/s^2
};

/// State of an arm that starts on its desired motion.
inline JointState on_trajectory(const DesiredMotion& motion) { return {motion.q, motion.dq}; }

}  // namespace offnominal::sim
