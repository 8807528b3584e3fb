// Equations of motion of the hidden robot and their integration.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "offnominal/sim/hidden/bristle.hpp"
#include "offnominal/sim/hidden/robot.hpp"

namespace offnominal::sim::hidden {

struct PlantState {
  Eigen::Vector2d motor_q = Eigen::Vector2d::Zero();   ///< rad, seen at the joint
  Eigen::Vector2d motor_dq = Eigen::Vector2d::Zero();  ///< rad/s
  Eigen::Vector2d link_q = Eigen::Vector2d::Zero();    ///< equals motor_q at a rigid joint
  Eigen::Vector2d link_dq = Eigen::Vector2d::Zero();
  Eigen::Vector2d stretch = Eigen::Vector2d::Zero();  ///< of the friction's bristle, of its width
  Eigen::Vector2d soft_stretch = Eigen::Vector2d::Zero();
  Eigen::Vector2d belt_stretch = Eigen::Vector2d::Zero();
  Eigen::Vector2d gear_load_nm = Eigen::Vector2d::Zero();  ///< torque through the gear, last step
};

class Plant {
 public:
  /// `contacts` are those of this run.
  explicit Plant(const Robot& robot, std::vector<Contact> contacts = {});

  /// Bristles at rest, the transmission loaded by what the motion needs.
  [[nodiscard]] PlantState start(const Eigen::Vector2d& q, const Eigen::Vector2d& dq,
                                 const Eigen::Vector2d& ddq = Eigen::Vector2d::Zero()) const;

  /// One step of the midpoint rule under the torque that the motors give. The bristles advance
  /// exactly for the velocity of the step, so stiff friction does not bound h_s; a joint of two
  /// masses does: h_s well below 1 / (its angular frequency).
  void step(PlantState& state, double t_s, const Eigen::Vector2d& motor_torque_nm,
            double h_s) const;

  /// Torque through the transmission of a joint that is not rigid; 0 inside the gap, N m.
  [[nodiscard]] double transmitted_torque(int joint, const PlantState& state) const;

  /// Friction of motor and gear, N m, positive against a positive velocity.
  [[nodiscard]] double friction_torque(int joint, const PlantState& state, double t_s) const;

  [[nodiscard]] const PlanarArm& arm() const { return arm_; }

 private:
  struct Rates {
    Eigen::Vector2d motor_ddq, link_ddq, gear_load_nm;
  };
  [[nodiscard]] Rates rates(const PlantState& state, double t_s,
                            const Eigen::Vector2d& motor_torque_nm) const;
  [[nodiscard]] static MotorSide motor_side(int joint, const PlantState& state, double t_s);
  [[nodiscard]] double motor_load(int joint, const PlantState& state, double t_s) const;
  [[nodiscard]] double link_load(int joint, const PlantState& state, double t_s) const;
  void advance_bristles(PlantState& state, const Eigen::Vector2d& velocity, double h_s) const;

  Robot robot_;
  PlanarArm arm_;
  std::vector<Contact> contacts_;
  std::array<Bristle, 2> bristles_, soft_bristles_, belts_;
};

}  // namespace offnominal::sim::hidden
