#include "arm_sketch.hpp"

#include "exchange/export_robot.hpp"

namespace offnominal::bench {

using Eigen::Index;

ArmSketch arm_sketch_of(const sim::MujocoPlant& plant, const sim::hidden::ArmMotion& motion,
                        double duration_s) {
  constexpr double kGridS = 0.02;
  const auto rows = static_cast<Index>(duration_s / kGridS);
  ArmSketch sketch;
  for (auto* columns : {&sketch.q, &sketch.dq, &sketch.ddq, &sketch.tau}) {
    columns->resize(rows, static_cast<Index>(motion.joints.size()));
  }
  for (Index row = 0; row < rows; ++row) {
    const sim::DesiredMotion at = motion.at(static_cast<double>(row) * kGridS);
    sketch.q.row(row) = at.q;
    sketch.dq.row(row) = at.dq;
    sketch.ddq.row(row) = at.ddq;
    sketch.tau.row(row) = plant.inverse_dynamics(at);
  }
  return sketch;
}

sim::MujocoModel mujoco_model_of(const desk::RobotDescription& robot) {
  return sim::MujocoModel::from_text(desk::exchange::export_mjcf(robot, "").text);
}

sim::MujocoPlant mujoco_plant_of(const sim::MujocoModel& model) {
  const auto count = static_cast<Index>(model.joints().size());
  return {model, {.start = {sim::JointVector::Zero(count), sim::JointVector::Zero(count)}}};
}

}  // namespace offnominal::bench
