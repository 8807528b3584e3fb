#include "compare/error_variable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "common/effort_name.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

const char* name_of(ErrorVariable variable) {
  switch (variable) {
    case ErrorVariable::kPosition:
      return "position";
    case ErrorVariable::kVelocity:
      return "velocity";
    case ErrorVariable::kAcceleration:
      return "acceleration";
    case ErrorVariable::kLoad:
      return "load";
    case ErrorVariable::kSinceReversal:
      break;
  }
  return "since_reversal";
}

std::optional<ErrorVariable> error_variable(std::string_view name) {
  const auto* const found =
      std::find_if(kErrorVariables.begin(), kErrorVariables.end(),
                   [&](ErrorVariable variable) { return name == name_of(variable); });
  if (found == kErrorVariables.end()) return std::nullopt;
  return *found;
}

report::Axis axis_of(const Comparison& comparison, const ErrorOver& over, std::size_t of_joint) {
  const std::string& effort = comparison.joints[over.joint].unit;
  const std::string length = effort == "N" ? "m" : "rad";
  report::Axis axis;
  axis.name = name_of(over.variable);
  switch (over.variable) {
    case ErrorVariable::kPosition:
      axis.unit = length;
      break;
    case ErrorVariable::kVelocity:
      axis.unit = length + "/s";
      break;
    case ErrorVariable::kAcceleration:
      axis.unit = length + "/s^2";
      break;
    case ErrorVariable::kLoad:
      axis.name = "model " + std::string(effort_name(effort));
      axis.unit = effort;
      break;
    case ErrorVariable::kSinceReversal:
      axis.name = "time since reversal";
      axis.unit = "s";
      break;
  }
  if (over.joint != of_joint) axis.name += fmt::format(" of joint {}", over.joint + 1);
  return axis;
}

VectorXd values_of(const Comparison& comparison, const ErrorOver& over) {
  const auto column = static_cast<Index>(over.joint);
  switch (over.variable) {
    case ErrorVariable::kPosition:
      return comparison.q.col(column);
    case ErrorVariable::kVelocity:
      return comparison.dq.col(column);
    case ErrorVariable::kAcceleration:
      return comparison.ddq.col(column);
    case ErrorVariable::kLoad:
      return comparison.model.col(column);
    case ErrorVariable::kSinceReversal:
      break;
  }
  return since_reversal(comparison.t_s, comparison.dq.col(column));
}

VectorXd since_reversal(const Eigen::Ref<const VectorXd>& t_s,
                        const Eigen::Ref<const VectorXd>& velocity) {
  constexpr double kStill = 0.02;  // of the largest velocity
  VectorXd since = VectorXd::Constant(t_s.size(), std::numeric_limits<double>::quiet_NaN());
  if (t_s.size() == 0) return since;
  const double least = kStill * velocity.cwiseAbs().maxCoeff();
  bool has_turned = false;
  double turned_s = 0;
  double direction = 0;
  for (Index i = 0; i < t_s.size(); ++i) {
    if (velocity[i] * direction < 0 && std::abs(velocity[i]) > least) {
      has_turned = true;
      turned_s = t_s[i];
    }
    if (std::abs(velocity[i]) > least) direction = velocity[i];
    if (has_turned) since[i] = t_s[i] - turned_s;
  }
  return since;
}

}  // namespace offnominal::desk
