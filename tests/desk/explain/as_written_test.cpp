// What is written where a part of what was found is not.

#include "explain/as_written.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "compare/filter_plan.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Friction that was fitted beside an effect that is not written fits nothing without it.
TEST(TakeBetterNumbers, TakesThoseOfTheJointsAskedWhoseErrorFalls) {
  const RobotDescription real = test::serial_arm(3);
  const std::vector<Log> logs{test::record(real, {.duration_s = 10})};
  const FilterPlan plan = plan_filter(logs, real);
  const Judged by{real, logs, logs, plan};
  RobotDescription robot = real;
  robot.effects[0].parameters[0] = 3;  // viscous friction of joint 1, and of joint 2
  robot.effects[2].parameters[0] = 3;
  RobotDescription other = real;
  other.effects[4].parameters[0] = 5;  // of joint 3, which is worse then
  RobotDescription written = robot;
  EXPECT_THAT(take_better_numbers(by, other, {1, 0, 1}, written), ElementsAre(0));
  EXPECT_EQ(written.effects[0].parameters, real.effects[0].parameters);
  EXPECT_EQ(written.effects[2].parameters, robot.effects[2].parameters);
  EXPECT_EQ(written.effects[4].parameters, real.effects[4].parameters);
  EXPECT_THAT(take_better_numbers(by, robot, {1, 1, 1}, written), IsEmpty());
}

// Two ripples stand in the same order in both; what a link weighs belongs to the other links.
TEST(TakeBetterNumbers, KnowsSeveralOfAKindApartAndLeavesMasses) {
  RobotDescription real = test::serial_arm(2);
  const auto ripple = [](double size, double order) {
    return test::effect_of(EffectKind::kCoggingTorque, 1, {size, 0, order}, true);
  };
  real.effects.push_back(ripple(0.5, 7));
  real.effects.push_back(ripple(0.4, 12));
  real.effects.push_back(test::effect_of(EffectKind::kTipPayload, 1, {0.5, 0.1, 0, 0}, true));
  const std::vector<Log> logs{test::record(real, {.duration_s = 10})};
  const FilterPlan plan = plan_filter(logs, real);
  RobotDescription robot = real;
  robot.effects[4] = ripple(0.1, 7);
  robot.effects[5] = ripple(0.1, 12);
  robot.effects[6].parameters[0] = 0.45;
  EXPECT_THAT(take_better_numbers({robot, logs, logs, plan}, real, {0, 1}, robot), ElementsAre(1));
  EXPECT_EQ(robot.effects[4].parameters, real.effects[4].parameters);
  EXPECT_EQ(robot.effects[5].parameters, real.effects[5].parameters);
  EXPECT_EQ(robot.effects[6].parameters[0], 0.45);
}

}  // namespace
}  // namespace offnominal::desk
