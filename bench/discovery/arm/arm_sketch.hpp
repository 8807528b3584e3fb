#pragma once

#include <Eigen/Core>
#include <cmath>

#include "offnominal/sim/hidden/arm_motion.hpp"
#include "offnominal/sim/plants/mujoco_plant.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// What a motion asks of an arm, on a grid of 20 ms; columns: joints.
struct ArmSketch {
  Eigen::ArrayXXd q, dq, ddq, tau;
};
ArmSketch arm_sketch_of(const sim::MujocoPlant& plant, const sim::hidden::ArmMotion& motion,
                        double duration_s);

// The robot in MuJoCo, through the text of `offnominal export-mjcf`; at rest at 0.
sim::MujocoModel mujoco_model_of(const desk::RobotDescription& robot);
sim::MujocoPlant mujoco_plant_of(const sim::MujocoModel& model);

template <typename Values>
double rms_of(const Values& values) {
  return std::sqrt(values.square().mean());
}

}  // namespace offnominal::bench
