#include "loop/refusal_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "desk/sil/serial_robot.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

using controller::Fault;
using testing::HasSubstr;
using testing::StartsWith;

// GIVEN a file that says no torque limit of two joints THEN they are named, and where it is said.
TEST(RefusalWords, NameTheJointsThatMissATorqueLimit) {
  std::string text = test::serial_robot_text(3);
  const std::string limit = "torque = 150.0\n";
  text.erase(text.find(limit), limit.size());
  text.erase(text.rfind(limit), limit.size());
  const RobotDescription robot = parse_robot(text, "r.toml");
  EXPECT_THAT(mend_of(Fault::kNoTorqueLimit, robot),
              StartsWith("joint 1 (joint1), 3 (joint3): give `torque` in [joint.limits]"));
}

TEST(RefusalWords, NameTheJointsThatMissGains) {
  RobotDescription robot = test::serial_robot(3);
  robot.joints[1].kd = 0;
  EXPECT_THAT(mend_of(Fault::kNoGains, robot), StartsWith("joint 2 (joint2): give kp_per_s2"));
}

TEST(RefusalWords, PointElsewhereForTheRest) {
  EXPECT_THAT(mend_of(Fault::kArmMoving, test::serial_robot(1)), HasSubstr("troubleshooting.md"));
}

}  // namespace
}  // namespace offnominal::desk
