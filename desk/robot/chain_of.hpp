#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/model/chain.hpp>
#include <offnominal/vector.hpp>
#include <stdexcept>
#include <string>

#include "robot/robot.hpp"
#include "robot/transmission.hpp"

// From a robot to the types of the core.

namespace offnominal::desk {

namespace detail {

// A limit that is not set is the largest double, which a float cannot hold.
template <typename Scalar>
[[nodiscard]] Scalar scalar_of(double value) {
  constexpr double kLargest = static_cast<double>(std::numeric_limits<Scalar>::max());
  return static_cast<Scalar>(std::clamp(value, -kLargest, kLargest));
}

template <typename Scalar, std::size_t Size>
[[nodiscard]] std::array<Scalar, Size> scalars_of(const std::array<double, Size>& values) {
  std::array<Scalar, Size> result{};
  for (std::size_t i = 0; i < Size; ++i) result[i] = scalar_of<Scalar>(values[i]);
  return result;
}

template <typename Scalar>
[[nodiscard]] Joint<Scalar> joint_of(const Joint<double>& from) {
  Joint<Scalar> joint;
  joint.type = from.type;
  joint.axis = scalars_of<Scalar>(from.axis);
  joint.origin_m = scalars_of<Scalar>(from.origin_m);
  joint.rotation = scalars_of<Scalar>(from.rotation);
  joint.mass_kg = scalar_of<Scalar>(from.mass_kg);
  joint.centre_of_mass_m = scalars_of<Scalar>(from.centre_of_mass_m);
  joint.inertia_kg_m2 = scalars_of<Scalar>(from.inertia_kg_m2);
  joint.min_position = scalar_of<Scalar>(from.min_position);
  joint.max_position = scalar_of<Scalar>(from.max_position);
  joint.max_velocity = scalar_of<Scalar>(from.max_velocity);
  joint.max_torque = scalar_of<Scalar>(from.max_torque);
  return joint;
}

// Joints beyond those of the transmission have a motor each.
template <int N, typename Scalar>
[[nodiscard]] Transmission<N, Scalar> transmission_of(const RobotDescription& robot) {
  Transmission<N, Scalar> transmission;
  const Eigen::MatrixXd matrix = motor_per_joint(*robot.transmission);
  const Eigen::VectorXd offset = motor_offset_rad(*robot.transmission);
  for (Eigen::Index motor = 0; motor < matrix.rows(); ++motor) {
    const auto row = static_cast<std::size_t>(motor);
    transmission.motor_offset_rad[row] = scalar_of<Scalar>(offset[motor]);
    for (Eigen::Index joint = 0; joint < matrix.cols(); ++joint) {
      transmission.motor_per_joint[row * transmission.kMost + static_cast<std::size_t>(joint)] =
          scalar_of<Scalar>(matrix(motor, joint));
    }
  }
  return transmission;
}

// N: as a template of the core has it.
template <int N>
void require_joint_count(const RobotDescription& robot) {
  const int count = robot.joint_count();
  if constexpr (N == kRuntimeJoints) {
    if (count >= 1 && count <= kMaxJoints) return;
  } else {
    if (count == N) return;
  }
  throw std::invalid_argument(
      "robot " + robot.name + " has " + std::to_string(count) + " joints, not " +
      (N == kRuntimeJoints ? "1 to " + std::to_string(kMaxJoints) : std::to_string(N)));
}

}  // namespace detail

/// The chain that the core computes with, every number rounded to Scalar; with rigid transmissions:
/// effects that no chain can have are left out (require_carried() refuses them). N: kRuntimeJoints,
/// or where something is measured as firmware has it the robot's own number of joints. Throws
/// std::invalid_argument when the robot does not have N joints, or more effects than a chain of as
/// many joints holds on a controller.
template <int N, typename Scalar>
[[nodiscard]] Chain<N, Scalar> chain_of(const RobotDescription& robot) {
  detail::require_joint_count<N>(robot);
  const std::size_t most = kEffectsPerJoint * robot.joints.size();
  if (robot.effects.size() > most) {
    throw std::invalid_argument("robot " + robot.name + " has " +
                                std::to_string(robot.effects.size()) + " effects, at most " +
                                std::to_string(most) + " are allowed");
  }
  Chain<N, Scalar> chain;
  size_for(robot.joints.size(), chain.joints);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    chain.joints[i] = detail::joint_of<Scalar>(robot.joints[i].joint);
  }
  chain.gravity_m_s2 = detail::scalars_of<Scalar>(robot.gravity_m_s2);
  if (robot.transmission) chain.transmission = detail::transmission_of<N, Scalar>(robot);
  for (const RobotEffect& effect : robot.effects) {
    if (!chain_may_have(effect.kind)) continue;
    static_cast<void>(
        chain.effects.add({effect.kind, effect.joint, detail::scalars_of<Scalar>(effect.parameters),
                           effect.of_motor}));
  }
  return chain;
}

}  // namespace offnominal::desk
