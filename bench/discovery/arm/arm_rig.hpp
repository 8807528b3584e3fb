#pragma once

#include <Eigen/Core>
#include <vector>

#include "arm_effects.hpp"
#include "offnominal/sim/hidden/arm_motion.hpp"
#include "offnominal/sim/plants/mujoco_plant.hpp"

namespace offnominal::bench {

// A force on a link for a while.
struct ArmPush {
  double from_s = 0;
  double to_s = 0;
  Eigen::Index link = 0;  // from 0
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
};

// An arm in MuJoCo with everything that it hides, on the test stand.
struct ArmRig {
  sim::MujocoModel model;
  std::vector<ArmEffect> effects;
  std::vector<ArmPush> pushes;
  // Per joint: a drive gives so many times what it is told and logs.
  std::vector<double> torque_constant;
};

// What happened, one row a sample; columns: joints.
struct ArmRun {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, dq;
  Eigen::MatrixXd tau;  // told to the drives, as it acts at the sample's time
  // Per effect of the rig, rms over the samples of what the drive of its joint had to supply for
  // it, N m. Of a tip_payload 0.
  std::vector<double> effect_rms;
};

// Follows the motion at 1 kHz with computed torque of the arm as it is and a weak feedback; samples
// every `every` ticks.
ArmRun run_arm(const ArmRig& rig, const sim::hidden::ArmMotion& motion, double duration_s,
               int every);

// Inertia that each joint's drive feels with all others held, kg m^2, in the middle of the motion.
Eigen::VectorXd joint_inertias(const sim::MujocoPlant& plant, const sim::hidden::ArmMotion& motion);

}  // namespace offnominal::bench
