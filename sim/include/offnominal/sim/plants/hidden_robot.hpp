// The robot with something hidden in it, as a plant: its drives and its mechanics.
#pragma once

#include <deque>
#include <vector>

#include "offnominal/sim/hidden/plant.hpp"
#include "offnominal/sim/plant.hpp"

namespace offnominal::sim {

/// What is hidden is there from the start and is no fault: fault_function() is zero. Every step has
/// the same period.
class HiddenRobot final : public Plant {
 public:
  /// `contacts` are those of this run; the rest is as hidden::Plant::start() has it.
  HiddenRobot(const hidden::Robot& robot, std::vector<hidden::Contact> contacts,
              const DesiredMotion& start);

  /// Of the motors, where the encoders sit.
  [[nodiscard]] const JointState& state() const override { return state_; }
  void step(double t_s, const JointVector& tau, double period_s) override;
  [[nodiscard]] JointVector fault_function(double /*t_s*/, const JointVector& tau) const override {
    return JointVector::Zero(tau.size());
  }

  /// Motors and links apart.
  [[nodiscard]] const hidden::PlantState& inner_state() const { return inner_; }
  /// Mean of what the motors gave over the last step, N m.
  [[nodiscard]] const Eigen::Vector2d& given_nm() const { return given_; }

 private:
  // What a motor gives at t_s of the torques that it was told.
  [[nodiscard]] double given_torque(Eigen::Index joint, double t_s, double period_s) const;

  hidden::Robot robot_;
  hidden::Plant plant_;
  hidden::PlantState inner_;
  JointState state_;
  std::deque<Eigen::Vector2d> told_;  // one a step, as far back as a drive is late
  double first_told_ = 0.0;           // number of the step that told_ begins with
  Eigen::Vector2d given_ = Eigen::Vector2d::Zero();
};

}  // namespace offnominal::sim
