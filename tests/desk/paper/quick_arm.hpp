#pragma once

#include "paper/two_link_robot.hpp"

namespace offnominal::test {

/// Length of a tick in the paper's experiment, s; where the sanitizers watch four times the
/// paper's: every line of the loop runs as it does otherwise, a quarter as often.
#ifdef OFFNOMINAL_SANITIZE
inline constexpr double kPaperTickS = 0.004;
#else
inline constexpr double kPaperTickS = 0.001;
#endif

/// The paper's arm with that tick.
inline desk::RobotDescription quick_arm() {
  desk::RobotDescription robot = desk::paper::two_link_robot();
  robot.estimator.period_s = kPaperTickS;
  return robot;
}

}  // namespace offnominal::test
