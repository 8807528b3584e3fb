#include "motion/contender.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "robot/robot_file.hpp"
#include "support/robots.hpp"

namespace offnominal::desk::motion {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using test::kRobots;

class Contenders : public ::testing::Test {
 protected:
  std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(contender_of(text, arm_, "--separate"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  RobotDescription arm_ = read_robot_file(kRobots / "two_link.toml");
  RobotDescription carriage_ = read_robot_file(kRobots / "emps.toml");
};

TEST_F(Contenders, AreReadAsExplainNamesThem) {
  const Contender one = contender_of("stribeck_friction@2", arm_, "--separate");
  EXPECT_STREQ(one.effect->name(), "stribeck_friction");
  EXPECT_EQ(one.joint, 1);
  EXPECT_EQ(text_of(one), "stribeck_friction@2");
}

TEST_F(Contenders, NeedNoJointWhereThereIsOnlyOne) {
  EXPECT_EQ(contender_of("backlash", carriage_, "--excite").joint, 0);
  EXPECT_EQ(contender_of("tip_payload", arm_, "--excite").joint, 1);
  EXPECT_THAT(refusal("backlash"), AllOf(HasSubstr("several joints"), HasSubstr("--separate")));
}

TEST_F(Contenders, AreRefusedWhenThereIsNoSuchEffectOrJoint) {
  EXPECT_THAT(refusal("coulomb_frction@1"), HasSubstr("write coulomb_friction"));
  EXPECT_THAT(refusal(""), HasSubstr("viscous_friction"));
  for (const char* text : {"backlash@0", "backlash@3", "backlash@-1", "backlash@", "backlash@1x",
                           "backlash@1@2", "backlash@99999999999"}) {
    EXPECT_THAT(refusal(text), HasSubstr("a joint from 1 to 2")) << text;
  }
}

TEST_F(Contenders, AreRefusedWhereTheyCannotAct) {
  EXPECT_THAT(refusal("tip_payload@1"), HasSubstr("can act"));
  EXPECT_THROW(static_cast<void>(contender_of("joint_coupling@1", carriage_, "--excite")),
               InputError);
}

TEST_F(Contenders, AreRefusedWhereTheRobotFileHasThem) {
  RobotEffect known;
  known.kind = EffectKind::kViscousFriction;
  known.joint = 1;
  known.parameters = {0.5};
  arm_.effects.push_back(known);
  EXPECT_THAT(refusal("viscous_friction@2"), HasSubstr("already"));
  EXPECT_EQ(refusal("viscous_friction@1"), "");
  for (const Contender& one : contenders_on(arm_, {0, 1})) {
    EXPECT_NE(text_of(one), "viscous_friction@2");
    EXPECT_EQ(refusal(text_of(one)), "");
  }
}

}  // namespace
}  // namespace offnominal::desk::motion
