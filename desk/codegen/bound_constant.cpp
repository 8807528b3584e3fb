#include "codegen/bound_constant.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <offnominal/model/quantity.hpp>
#include <span>

#include "codegen/cpp_text.hpp"
#include "robot/bound_names.hpp"

namespace offnominal::desk {
namespace {

using cpp_text::member;

// The unit of velocities over several joints, where they have one.
std::string norm_unit(const RobotDescription& robot, Quantity quantity) {
  const JointType first = robot.joints.front().joint.type;
  for (const RobotJoint& joint : robot.joints) {
    if (joint.joint.type != first) return "rad/s and m/s mixed";
  }
  return unit_of(quantity, first);
}

std::string table_text(const UncertaintyBound<kRuntimeJoints, double>& bound,
                       const RobotDescription& robot) {
  const BoundVariableName& variable = bound_variable_names(bound.variable);
  const JointType type = robot.joints[bound.joint].joint.type;
  const auto in_use = [&](const auto& values) {
    return cpp_text::numbers(std::span<const double>(values.data(), bound.points));
  };
  std::string text =
      member("variable", fmt::format("offnominal::BoundVariable::{}", variable.enumerator));
  text += member("joint", std::to_string(bound.joint), "from 0");
  text += member("points", std::to_string(bound.points));
  text += member("at", in_use(bound.at), unit_of(variable.quantity, type));
  return text + member("value", in_use(bound.value), "mu_bar");
}

std::string norm_bound_text(const UncertaintyBound<kRuntimeJoints, double>& bound,
                            const RobotDescription& robot) {
  constexpr std::array kKinds{"kConstant", "kScaledNorm", "kTable"};
  std::string text = member("kind", fmt::format("offnominal::BoundKind::{}",
                                                kKinds.at(static_cast<std::size_t>(bound.kind))));
  text += member("velocity_error", cpp_text::number(bound.velocity_error),
                 norm_unit(robot, Quantity::kVelocity) + ", of the measurement");
  switch (bound.kind) {
    case BoundKind::kConstant:
      return text + member("offset", cpp_text::number(bound.offset), "mu_bar");
    case BoundKind::kScaledNorm:
      text += member("offset", cpp_text::number(bound.offset));
      text +=
          member("scale", cpp_text::number(bound.scale), "mu_bar = scale (|matrix dq| + offset)");
      return text + member("matrix", cpp_text::numbers(bound.matrix), "row by row");
    case BoundKind::kTable:
      return text + table_text(bound, robot);
  }
  return text;
}

std::string joint_bound_text(const JointBound<double>& bound, JointType type) {
  const std::string unit(unit_of(Quantity::kEffort, type));
  const auto in_use = [&](const auto& values) {
    return cpp_text::numbers(std::span<const double>(values.data(), bound.points));
  };
  const BoundVariableName& variable = bound_variable_names(bound.variable);
  std::string text;
  if (bound.points > 1) {
    text += member("variable", fmt::format("offnominal::BoundVariable::{}", variable.enumerator));
  }
  text += member("points", std::to_string(bound.points));
  if (bound.points > 1 || bound.at[0] != 0)
    text += member("at", in_use(bound.at), unit_of(variable.quantity, type));
  text += member("value", in_use(bound.value), unit);
  text += member("momentum_error", cpp_text::number(bound.momentum_error), unit + " s");
  return text + member("act_ratio", cpp_text::number(bound.act_ratio), "times the threshold");
}

// ".joints = {{...}}," of the bounds of one filter.
std::string joint_bounds_constant(const PerJoint<kRuntimeJoints, JointBound<double>>& bounds,
                                  const RobotDescription& robot) {
  std::string joints;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const RobotJoint& joint = robot.joints[i];
    joints += cpp_text::comment(fmt::format("joint {}: {}", i + 1, joint.name));
    joints +=
        "{\n" + cpp_text::indented(joint_bound_text(bounds[i], joint.joint.type), "    ") + "},\n";
  }
  return ".joints = {{\n" + cpp_text::indented(joints, "    ") + "}},\n";
}

}  // namespace

BoundConstant bound_constant(const UncertaintyBound<kRuntimeJoints, double>& bound,
                             const RobotDescription& robot) {
  return {.type = "offnominal::UncertaintyBound<kJoints, Scalar>",
          .members = norm_bound_text(bound, robot),
          .remark = "mu_bar, rad/s^2 (m/s^2): what |M^-1 (unmodelled torque)| does not exceed."};
}

BoundConstant bound_constant(const TorqueBound<kRuntimeJoints, double>& bound,
                             const RobotDescription& robot) {
  std::string members = joint_bounds_constant(bound.joints, robot);
  if (bound.fast.alpha > 0) {
    const std::string fast = member("alpha", cpp_text::number(bound.fast.alpha), "1/s") +
                             joint_bounds_constant(bound.fast.joints, robot);
    members += cpp_text::comment("of the second, faster filter");
    members += ".fast = {\n" + cpp_text::indented(fast, "    ") + "},\n";
  }
  return {.type = "offnominal::TorqueBound<kJoints, Scalar>",
          .members = members,
          .remark = "mu_bar of each joint, N m or N: what its unmodelled torque does not exceed."};
}

}  // namespace offnominal::desk
