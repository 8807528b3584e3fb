#include "identify/unknown.hpp"

#include <fmt/format.h>

#include "compare/inverse_model.hpp"
#include "robot/effect_text.hpp"
#include "signal/shift.hpp"

namespace offnominal::desk {
namespace {

const ParameterInfo& info_of_parameter(const RobotDescription& robot, const Unknown& unknown) {
  return info_of(robot.effects[unknown.effect].kind)->parameters[unknown.parameter];
}

// The effect with this linear parameter 1 and the others 0.
Effect<double> unit_effect(const RobotDescription& robot, const Unknown& unknown) {
  Effect<double> effect = robot.effects[unknown.effect];
  const auto parameters = info_of(effect.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role == ParameterRole::kLinear) effect.parameters[i] = 0;
  }
  effect.parameters[unknown.parameter] = 1;
  return effect;
}

// The torque is linear in the parameter while all else stands still; in a delay nearly so, over no
// more than a sample.
Eigen::VectorXd of_path_effect(const RobotDescription& robot, const Unknown& unknown,
                               const Motion& motion) {
  const auto with = [&](double value) {
    RobotDescription changed = robot;
    changed.effects[unknown.effect].parameters[unknown.parameter] = value;
    return model_torque(changed, motion).col(static_cast<Eigen::Index>(unknown.joint)).eval();
  };
  if (info_of_parameter(robot, unknown).quantity != Quantity::kTime) return with(1) - with(0);
  const double value = robot.effects[unknown.effect].parameters[unknown.parameter];
  const double period_s = motion.period_s();
  return (with(value + 0.5 * period_s) - with(value - 0.5 * period_s)) / period_s;
}

// What a torque of a motor is at the joints that it moves.
std::vector<JointColumn> at_joints(const RobotDescription& robot, std::size_t motor,
                                   const Eigen::VectorXd& torque) {
  std::vector<JointColumn> columns;
  for (const MovedJoint& moved : joints_of_motor(robot, motor)) {
    columns.push_back({static_cast<std::size_t>(moved.joint), moved.motor_per_joint * torque});
  }
  return columns;
}

}  // namespace

std::vector<Unknown> unknowns_of_effect(const RobotDescription& robot, std::size_t effect,
                                        bool is_new) {
  std::vector<Unknown> unknowns;
  const RobotEffect& of = robot.effects[effect];
  const auto parameters = info_of(of.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role != ParameterRole::kLinear) continue;
    Unknown unknown;
    unknown.effect = effect;
    unknown.parameter = i;
    unknown.joint = of.joint;
    unknown.start = of.parameters[i];
    unknown.is_new = is_new;
    unknowns.push_back(unknown);
  }
  return unknowns;
}

std::string name_of(const RobotDescription& robot, const Unknown& unknown) {
  if (unknown.kind == Unknown::Kind::kLinkScale) {
    return fmt::format("mass and inertia of link {}", unknown.joint + 1);
  }
  const RobotEffect& effect = robot.effects[unknown.effect];
  return fmt::format("{}.{} of {}", info_of(effect.kind)->name,
                     info_of_parameter(robot, unknown).name, place_of(effect));
}

std::vector<JointColumn> regressor_before_path(const RobotDescription& robot,
                                               const Unknown& unknown, const Motion& motion) {
  Eigen::MatrixXd torque;
  if (unknown.kind == Unknown::Kind::kLinkScale) {
    torque = link_torque(robot, unknown.joint, motion);
  } else {
    const Effect<double> effect = unit_effect(robot, unknown);
    if (is_torque_effect(effect.kind)) {
      const JointType type = robot.type_of(effect);
      if (effect.of_motor) {
        return at_joints(robot, unknown.joint,
                         torque_of_effect(effect, type, motor_motion(robot, motion)));
      }
      return {{unknown.joint, torque_of_effect(effect, type, motion)}};
    }
    torque = torque_of_inertial_effect(robot, effect, motion);
  }
  std::vector<JointColumn> columns;
  for (const std::size_t joint : joints_of(robot, unknown)) {
    columns.push_back({joint, torque.col(static_cast<Eigen::Index>(joint))});
  }
  return columns;
}

void pass_path(const RobotDescription& robot, const Unknown& unknown, const ToldTorque& told,
               std::vector<JointColumn>& columns) {
  for (JointColumn& column : columns) {
    const auto joint = static_cast<Eigen::Index>(column.joint);
    if (is_load(robot, unknown)) {
      column.values.array() *= told.per_load.col(joint).array();
    } else {
      column.values *= told.per_given[joint];
    }
    column.values = ahead_by(column.values, told.samples_ahead[joint]);
  }
}

std::vector<JointColumn> regressor(const RobotDescription& robot, const Unknown& unknown,
                                   const Motion& motion) {
  std::optional<ToldTorque> told;
  return regressor(robot, unknown, motion, told);
}

std::vector<JointColumn> regressor(const RobotDescription& robot, const Unknown& unknown,
                                   const Motion& motion, std::optional<ToldTorque>& told) {
  const bool of_path = unknown.kind == Unknown::Kind::kEffectParameter &&
                       is_path_effect(robot.effects[unknown.effect].kind);
  if (of_path) return {{unknown.joint, of_path_effect(robot, unknown, motion)}};
  std::vector<JointColumn> columns = regressor_before_path(robot, unknown, motion);
  if (has_path_effect(robot)) {
    if (!told) told = told_torque(robot, motion);
    pass_path(robot, unknown, *told, columns);
  }
  return columns;
}

bool is_load(const RobotDescription& robot, const Unknown& unknown) {
  if (unknown.kind == Unknown::Kind::kLinkScale) return true;
  const EffectKind kind = robot.effects[unknown.effect].kind;
  return !is_torque_effect(kind) && !is_path_effect(kind);
}

std::vector<std::size_t> joints_of(const RobotDescription& robot, const Unknown& unknown) {
  const bool own_joint_only =
      unknown.kind == Unknown::Kind::kEffectParameter &&
      (is_torque_effect(robot.effects[unknown.effect].kind) ||
       is_path_effect(robot.effects[unknown.effect].kind) ||
       info_of(robot.effects[unknown.effect].kind)->action == EffectAction::kReflectedInertia);
  std::vector<std::size_t> joints;
  if (own_joint_only && robot.effects[unknown.effect].of_motor) {
    for (const MovedJoint& moved : joints_of_motor(robot, unknown.joint)) {
      joints.push_back(static_cast<std::size_t>(moved.joint));
    }
    return joints;
  }
  if (own_joint_only) return {unknown.joint};
  for (std::size_t joint = 0; joint <= unknown.joint; ++joint) joints.push_back(joint);
  return joints;
}

}  // namespace offnominal::desk
