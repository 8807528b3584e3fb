#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "desk/support/effect_parameter.hpp"
#include "identify/add.hpp"

namespace offnominal::test {

// A parameter of the first effect of that kind in the robot that add() made.
inline double value_of(const desk::AddResult& result, EffectKind kind, const std::string& name) {
  for (const desk::RobotEffect& effect : result.robot.effects) {
    if (effect.kind == kind) return parameter_of(effect, name);
  }
  ADD_FAILURE() << name;
  return std::nan("");
}

}  // namespace offnominal::test
