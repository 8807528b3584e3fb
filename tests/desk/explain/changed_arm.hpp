#pragma once

#include <gtest/gtest.h>

#include <string>

#include "explain/explain.hpp"
#include "serial_arm.hpp"

// Robots that become others, and what is said of them.

namespace offnominal::test {

inline desk::RobotDescription with(desk::RobotDescription robot, const desk::RobotEffect& effect) {
  robot.effects.push_back(effect);
  return robot;
}

inline double number(const desk::Change& change, const std::string& name) {
  for (const desk::Estimate& one : change.by) {
    if (one.value.name == name) return one.value.value;
  }
  ADD_FAILURE() << "no " << name;
  return 0;
}

}  // namespace offnominal::test
