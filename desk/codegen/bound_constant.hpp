// The uncertainty bound of either space as the text of a C++ header.
#pragma once

#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

struct BoundConstant {
  std::string type;     // of the core, of kJoints and Scalar
  std::string members;  // of its initialiser, lines
  std::string remark;   // what is bounded
};

[[nodiscard]] BoundConstant bound_constant(const UncertaintyBound<kRuntimeJoints, double>& bound,
                                           const RobotDescription& robot);
[[nodiscard]] BoundConstant bound_constant(const TorqueBound<kRuntimeJoints, double>& bound,
                                           const RobotDescription& robot);

}  // namespace offnominal::desk
