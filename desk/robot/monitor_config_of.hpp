#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/arming.hpp>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <offnominal/monitor.hpp>
#include <offnominal/vector.hpp>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "robot/chain_of.hpp"
#include "robot/robot.hpp"

// A robot's settings as the core's configuration structs.

namespace offnominal::desk {

template <typename Scalar>
[[nodiscard]] EstimatorConfig<Scalar> estimator_config_of(const EstimatorSettings& settings) {
  EstimatorConfig<Scalar> config;
  config.period_s = static_cast<Scalar>(settings.period_s);
  config.alpha = static_cast<Scalar>(settings.alpha);
  config.learning_rate = static_cast<Scalar>(settings.learning_rate);
  config.weight_radius = static_cast<Scalar>(settings.weight_radius);
  config.dead_zone = settings.dead_zone;
  config.hidden_units = settings.hidden_units;
  config.initial_weight_range = static_cast<Scalar>(settings.initial_weight_range);
  config.seed = settings.seed;
  return config;
}

namespace detail {

template <int N, typename Scalar>
void set_scaled_norm(const ScaledNormBoundSettings& settings, std::size_t joints,
                     UncertaintyBound<N, Scalar>& bound) {
  size_for(joints * joints, bound.matrix);
  bound.kind = BoundKind::kScaledNorm;
  bound.scale = static_cast<Scalar>(settings.scale);
  bound.offset = static_cast<Scalar>(settings.offset);
  if (settings.matrix.size() > joints) {
    throw std::invalid_argument("the bound's matrix has more rows than the robot has joints");
  }
  for (std::size_t row = 0; row < settings.matrix.size(); ++row) {
    if (settings.matrix[row].size() != joints) {
      throw std::invalid_argument("a row of the bound's matrix has not one number per joint");
    }
    for (std::size_t column = 0; column < joints; ++column) {
      bound.matrix[joints * row + column] = static_cast<Scalar>(settings.matrix[row][column]);
    }
  }
}

template <int N, typename Scalar>
void set_table(const TableBoundSettings& settings, UncertaintyBound<N, Scalar>& bound) {
  if (settings.at.size() != settings.value.size() || settings.at.size() > bound.at.size()) {
    throw std::invalid_argument("the bound's table has too many points or not a value for each");
  }
  bound.kind = BoundKind::kTable;
  bound.variable = settings.variable;
  bound.joint = static_cast<std::uint8_t>(settings.joint);
  bound.points = static_cast<std::uint8_t>(settings.at.size());
  for (std::size_t i = 0; i < settings.at.size(); ++i) {
    bound.at[i] = static_cast<Scalar>(settings.at[i]);
    bound.value[i] = static_cast<Scalar>(settings.value[i]);
  }
}

}  // namespace detail

namespace detail {

template <typename Scalar>
[[nodiscard]] JointBound<Scalar> joint_bound_of(const JointBoundSettings& from) {
  JointBound<Scalar> joint;
  if (from.value.empty() || from.value.size() > joint.value.size() ||
      (from.value.size() > 1 && from.at.size() != from.value.size())) {
    throw std::invalid_argument("a joint's bound has not a place for each value, or too many");
  }
  joint.variable = from.variable;
  joint.points = static_cast<std::uint8_t>(from.value.size());
  for (std::size_t k = 0; k < from.value.size(); ++k) {
    joint.value[k] = static_cast<Scalar>(from.value[k]);
    if (!from.at.empty()) joint.at[k] = static_cast<Scalar>(from.at[k]);
  }
  joint.momentum_error = static_cast<Scalar>(from.momentum_error);
  joint.act_ratio = static_cast<Scalar>(from.act_ratio);
  return joint;
}

}  // namespace detail

/// Of a robot with that many joints; fast_alpha as EstimatorSettings has it. Throws
/// std::invalid_argument where the settings are not one per joint, or have too many points.
template <int N, typename Scalar>
[[nodiscard]] TorqueBound<N, Scalar> torque_bound_of(
    const BoundSettings& settings, double fast_alpha,
    std::size_t joints = static_cast<std::size_t>(N)) {
  const bool has_fast = fast_alpha > 0;
  if (settings.kind != BoundSettings::Kind::kPerJoint || settings.joints.size() != joints ||
      settings.fast.size() != (has_fast ? joints : 0)) {
    throw std::invalid_argument("the bound is not one per joint and filter");
  }
  TorqueBound<N, Scalar> bound;
  size_for(joints, bound.joints);
  for (std::size_t i = 0; i < joints; ++i) {
    bound.joints[i] = detail::joint_bound_of<Scalar>(settings.joints[i]);
  }
  if (!has_fast) return bound;
  bound.fast.alpha = static_cast<Scalar>(fast_alpha);
  size_for(joints, bound.fast.joints);
  for (std::size_t i = 0; i < joints; ++i) {
    bound.fast.joints[i] = detail::joint_bound_of<Scalar>(settings.fast[i]);
    bound.fast.joints[i].momentum_error = bound.joints[i].momentum_error;
  }
  return bound;
}

/// Of a robot with that many joints. Throws std::invalid_argument where the settings do not fit it.
template <int N, typename Scalar>
[[nodiscard]] UncertaintyBound<N, Scalar> bound_of(
    const BoundSettings& settings, std::size_t joints = static_cast<std::size_t>(N)) {
  UncertaintyBound<N, Scalar> bound;
  bound.velocity_error = static_cast<Scalar>(settings.velocity_error);
  switch (settings.kind) {
    case BoundSettings::Kind::kConstant:
      bound.kind = BoundKind::kConstant;
      bound.offset = static_cast<Scalar>(settings.constant.value);
      break;
    case BoundSettings::Kind::kScaledNorm:
      detail::set_scaled_norm(settings.scaled_norm, joints, bound);
      break;
    case BoundSettings::Kind::kTable:
      detail::set_table(settings.table, bound);
      break;
    case BoundSettings::Kind::kPerJoint:
      throw std::invalid_argument("a bound of torques where one of accelerations is asked for");
  }
  return bound;
}

template <int N, typename Scalar>
[[nodiscard]] ComputedTorqueGains<N, Scalar> gains_of(const RobotDescription& robot) {
  detail::require_joint_count<N>(robot);
  ComputedTorqueGains<N, Scalar> gains;
  size_for(robot.joints.size(), gains.kp, gains.kd);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    gains.kp[i] = static_cast<Scalar>(robot.joints[i].kp);
    gains.kd[i] = static_cast<Scalar>(robot.joints[i].kd);
  }
  return gains;
}

/// Throws std::invalid_argument where the settings do not fit a robot of N joints.
template <int N, typename Scalar>
[[nodiscard]] ArmingConfig<N, Scalar> arming_of(const RobotDescription& robot) {
  ArmingConfig<N, Scalar> config = default_arming(chain_of<N, Scalar>(robot));
  const auto set = [](const std::vector<double>& from, auto& into) {
    if (from.empty()) return;
    if (from.size() != into.size()) {
      throw std::invalid_argument("the settings of arming have not one number per joint");
    }
    for (std::size_t i = 0; i < into.size(); ++i) into[i] = static_cast<Scalar>(from[i]);
  };
  set(robot.arming.position_window, config.position_window);
  set(robot.arming.speed, config.speed);
  set(robot.arming.torque_rate, config.torque_rate);
  config.ramp_s = static_cast<Scalar>(robot.arming.ramp_s);
  return config;
}

/// Chain, estimator and bound in one. Compensation is limited to each joint's max_torque. Throws
/// std::invalid_argument when the robot has no bound of that Space, or not N joints.
template <int N, typename Scalar, typename Space = AccelerationSpace>
[[nodiscard]] MonitorConfig<N, Scalar, Space> monitor_config_of(const RobotDescription& robot) {
  if (!robot.bound)
    throw std::invalid_argument("robot " + robot.name + " has no uncertainty bound");
  MonitorConfig<N, Scalar, Space> config;
  config.chain = chain_of<N, Scalar>(robot);
  config.estimator = estimator_config_of<Scalar>(robot.estimator);
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    config.bound =
        torque_bound_of<N, Scalar>(*robot.bound, robot.estimator.fast_alpha, robot.joints.size());
  } else {
    config.bound = bound_of<N, Scalar>(*robot.bound, robot.joints.size());
  }
  config.torque_signal = robot.estimator.torque_signal;
  size_for(robot.joints.size(), config.max_compensation);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    config.max_compensation[i] = config.chain.joints[i].max_torque;
  }
  return config;
}

}  // namespace offnominal::desk
