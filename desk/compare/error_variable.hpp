#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "compare/compare.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What an error may be looked at over.
enum class ErrorVariable {
  kPosition,
  kVelocity,
  kAcceleration,
  kLoad,           // the torque that the model has there
  kSinceReversal,  // time since the joint turned round
};
inline constexpr std::array kErrorVariables{ErrorVariable::kPosition, ErrorVariable::kVelocity,
                                            ErrorVariable::kAcceleration, ErrorVariable::kLoad,
                                            ErrorVariable::kSinceReversal};

// Of any joint, whichever joint's error it is.
struct ErrorOver {
  ErrorVariable variable = ErrorVariable::kVelocity;
  std::size_t joint = 0;  // from 0
};

// "position", "velocity", "acceleration", "load", "since_reversal": in addresses and files.
const char* name_of(ErrorVariable variable);
std::optional<ErrorVariable> error_variable(std::string_view name);

// Its name and unit: "velocity", rad/s or m/s. The joint is named where it is not `of_joint`.
report::Axis axis_of(const Comparison& comparison, const ErrorOver& over, std::size_t of_joint);
// At every kept sample, in that unit; NaN before the joint turned round for the first time.
Eigen::VectorXd values_of(const Comparison& comparison, const ErrorOver& over);

// Seconds since the velocity last changed its sign; NaN before it did so first. A velocity below
// a fiftieth of its largest has no direction: noise at rest is no reversal. As long as each other.
Eigen::VectorXd since_reversal(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                               const Eigen::Ref<const Eigen::VectorXd>& velocity);

}  // namespace offnominal::desk
