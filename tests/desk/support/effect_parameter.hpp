#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::test {

/// The effect's parameter of that name; a failure and NaN where its kind has none.
inline double parameter_of(const desk::RobotEffect& effect, const std::string& name) {
  const auto parameters = info_of(effect.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (name == parameters[i].name) return effect.parameters[i];
  }
  ADD_FAILURE() << name;
  return std::nan("");
}

}  // namespace offnominal::test
