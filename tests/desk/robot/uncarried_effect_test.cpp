#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "robot/chain_of.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

// A transmission that is not rigid: a robot file has it, an on-board monitor cannot.

namespace offnominal::desk {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kElastic =
    "[[effect]]\nkind = \"joint_elasticity\"\njoint = 1\nstiffness = 8300.5\nfitted = true\n\n"
    "[[effect]]\nkind = \"backlash\"\njoint = 2\nwidth = 0.0012\n\n[estimator]";

std::string elastic_text() { return test::changed(test::kSampleRobot, "[estimator]", kElastic); }

TEST(UncarriedEffect, IsReadAndWrittenLikeAnyOther) {
  const RobotDescription robot = parse_robot(elastic_text(), "arm.toml");
  ASSERT_EQ(robot.effects.size(), 4U);
  EXPECT_EQ(robot.effects[2].kind, EffectKind::kJointElasticity);
  EXPECT_EQ(robot.effects[2].parameters[0], 8300.5);
  EXPECT_TRUE(robot.effects[2].fitted);
  EXPECT_EQ(robot.effects[3].kind, EffectKind::kBacklash);
  EXPECT_EQ(robot.effects[3].joint, 1);
  EXPECT_EQ(robot_text(parse_robot(robot_text(robot), "")), robot_text(robot));
}

TEST(UncarriedEffect, OfNoSizeIsRefused) {
  const std::string text = test::changed(elastic_text(), "stiffness = 8300.5", "stiffness = 0.0");
  try {
    static_cast<void>(parse_robot(text, "arm.toml"));
    FAIL() << "a stiffness of 0 was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("stiffness"), HasSubstr("1e-09")));
  }
}

TEST(UncarriedEffect, IsInNoChainOfTheCore) {
  const RobotDescription robot = parse_robot(elastic_text(), "arm.toml");
  const auto chain = chain_of<2, double>(robot);
  EXPECT_EQ(chain.effects.size, 2);
  EXPECT_EQ(validate(chain), Status::kOk);
}

TEST(UncarriedEffect, IsRefusedInOneSentenceWhereAMonitorIsToRun) {
  const RobotDescription robot = parse_robot(elastic_text(), "arm.toml");
  try {
    require_bound(robot, "arm.toml");
    FAIL() << "the monitor would have left the elasticity out";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("effect[3]: found joint_elasticity on joint 1, which the "
                                "on-board monitor cannot carry"),
                      HasSubstr("remove it from this file")));
  }
  EXPECT_NO_THROW(require_bound(parse_robot(test::kSampleRobot, "arm.toml"), "arm.toml"));
}

}  // namespace
}  // namespace offnominal::desk
