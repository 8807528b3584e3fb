#pragma once

#include <array>
#include <cstddef>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/model/quantity.hpp>
#include <string>

#include "robot/robot.hpp"

// What robot files, pages and generated code call the kinds of a bound and what a table is over:
// one row for each, in the order of the enumerations.

namespace offnominal::desk {

inline constexpr std::array<const char*, 4> kBoundKindNames{"constant", "scaled_norm", "table",
                                                            "per_joint"};

struct BoundVariableName {
  const char* name;
  const char* enumerator;  // of BoundVariable
  Quantity quantity;       // of the table's abscissae
};

inline constexpr std::array<BoundVariableName, 3> kBoundVariableNames{{
    {"position", "kPosition", Quantity::kPosition},
    {"speed", "kSpeed", Quantity::kVelocity},
    {"torque", "kTorque", Quantity::kEffort},
}};

[[nodiscard]] constexpr const char* name_of(BoundSettings::Kind kind) {
  return kBoundKindNames[static_cast<std::size_t>(kind)];
}

[[nodiscard]] constexpr const BoundVariableName& bound_variable_names(BoundVariable variable) {
  return kBoundVariableNames[static_cast<std::size_t>(variable)];
}

// Of a robot file: the tables of joints whose bound is over that variable, "over_speed".
[[nodiscard]] inline std::string key_of_tables(BoundVariable variable) {
  return std::string("over_") + bound_variable_names(variable).name;
}

}  // namespace offnominal::desk
