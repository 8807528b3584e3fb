#pragma once

#include <Eigen/Core>
#include <offnominal/model/effect.hpp>
#include <string>
#include <utility>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"

namespace offnominal::bench {

// An effect that the robot has and its file does not know. The physics is the simulator's: MuJoCo's
// friction loss, damping, armature and payload, and drives that add to a torque or scale it. Only
// names and the meaning of numbers are those of docs/robot-file.md:
//
// | effect | numbers | how it acts |
// |---|---|---|
// | coulomb_friction | level | friction loss |
// | viscous_friction | coefficient | damping |
// | stribeck_friction | level, stribeck_velocity | friction loss by the speed |
// | quadratic_friction | coefficient | damping by the speed |
// | friction_asymmetry | level, coefficient | friction loss and damping by the direction |
// | load_dependent_friction | factor | friction loss by the torque that passed the gear |
// | temperature_drift | level, coefficient, time_constant | friction loss and damping by the time |
// | rotor_inertia | inertia | armature |
// | tip_payload | mass, x, y, z | a point mass on the last link |
// | torque_offset | level | the drive gives so much less |
// | torque_scale | error | the drive gives 1 / (1 + error) of what it is told |
// | joint_stiffness | stiffness, rest_position | a torque by the position |
// | cogging_torque | sine, cosine, order | a torque by the position |
// | periodic_disturbance | sine, cosine, frequency | a torque by the time |
// | joint_coupling | coefficient, 0, source_joint from 1 | a torque by the other joint's velocity |
struct ArmEffect {
  EffectKind kind = EffectKind::kCoulombFriction;
  Eigen::Index joint = 0;  // from 0
  std::vector<std::pair<std::string, double>> numbers;
  double from_s = 0;  // it acts from this time on; 0: always

  [[nodiscard]] double number(std::size_t i) const { return numbers.at(i).second; }
  // A number that the analysis names, 0 where there is none.
  [[nodiscard]] double named(std::string_view name) const;
};

// A joint as the sizes of effects are drawn by it.
struct ArmJointScale {
  double torque = 0;  // rms over the motion, friction included, N m
  double load = 0;    // rms of what passes the gear
  double speed = 0;   // rms, rad/s; of a joint that stands 0
  double speed2 = 0;  // rms of the squared speed
  double acceleration = 0;
  double middle = 0;   // of the positions, rad
  double spread = 0;   // rms about it
  double coulomb = 0;  // of its known friction, N m
  double viscous = 0;  // N m s/rad
};

// Kinds that draw_effect() knows, without tip_payload.
const std::vector<EffectKind>& arm_effect_kinds();

// Whether a joint of this kind of scale can have it.
bool is_possible(EffectKind kind, const ArmJointScale& joint);

// Sizes as docs/discovery-benchmark.md lists them. `other`: the neighbour whose motion couples in.
ArmEffect draw_arm_effect(EffectKind kind, Eigen::Index joint,
                          const std::vector<ArmJointScale>& scales, Eigen::Index other,
                          sim::hidden::Draws& draws);

}  // namespace offnominal::bench
