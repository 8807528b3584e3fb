#pragma once

#include <cstddef>

#include "serial_arm.hpp"

namespace offnominal::test {

// An arm and a description of it by somebody else: its friction is a guess, and rotors it has none.
struct StrangersArm {
  explicit StrangersArm(std::size_t joints) : real(serial_arm(joints)), file(real) {
    for (std::size_t i = 0; i < joints; ++i) {
      real.effects.push_back(
          effect_of(EffectKind::kRotorInertia, static_cast<int>(i), {0.2}, true));
    }
    for (desk::RobotEffect& effect : file.effects) effect.parameters[0] *= 3;
  }
  desk::RobotDescription real;
  desk::RobotDescription file;
};

}  // namespace offnominal::test
