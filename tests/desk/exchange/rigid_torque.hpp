#pragma once

#include <random>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::test {

/// A state of so many joints: rad or m, and its derivatives.
struct MotionState {
  std::vector<double> q, dq, ddq;
};
[[nodiscard]] MotionState random_state(std::mt19937_64& generator, int joints);

/// What the core says that the drives have to give, effects included.
[[nodiscard]] std::vector<double> torque_of(const desk::RobotDescription& robot,
                                            const MotionState& state);

/// The largest difference as a share of the largest number, which counts as 1 at least.
[[nodiscard]] double deviation(const std::vector<double>& a, const std::vector<double>& b);

/// The robot without the effects that `drop` names.
template <typename Predicate>
desk::RobotDescription without(desk::RobotDescription robot, const Predicate& drop) {
  std::erase_if(robot.effects, drop);
  return robot;
}

}  // namespace offnominal::test
