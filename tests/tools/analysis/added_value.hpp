#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "analysis/add.hpp"

namespace offnominal::test {

// A parameter of the first effect of that kind in the robot that add() made.
inline double value_of(const tools::AddResult& result, EffectKind kind, const std::string& name) {
  for (const tools::RobotEffect& effect : result.robot.effects) {
    if (effect.kind != kind) continue;
    const auto parameters = info_of(kind)->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (name == parameters[i].name) return effect.parameters[i];
    }
  }
  ADD_FAILURE() << name;
  return std::nan("");
}

}  // namespace offnominal::test
