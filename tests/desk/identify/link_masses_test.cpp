#include "identify/link_masses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "desk/explain/serial_arm.hpp"

namespace offnominal::test {
namespace {

using desk::masses_beyond_belief;
using desk::RobotDescription;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RobotDescription arm(double first_kg, double second_kg) {
  RobotDescription robot = serial_arm(2);
  robot.effects.clear();
  robot.joints[0].joint.mass_kg = first_kg;
  robot.joints[1].joint.mass_kg = second_kg;
  return robot;
}

TEST(MassesBeyondBelief, GIVEN_a_link_nine_times_as_heavy_or_light_THEN_it_is_believed) {
  EXPECT_THAT(masses_beyond_belief(arm(1, 4), arm(9, 0.45)), IsEmpty());
}

TEST(MassesBeyondBelief, GIVEN_a_link_eleven_times_off_THEN_it_and_both_masses_are_named) {
  EXPECT_THAT(masses_beyond_belief(arm(1, 4), arm(11, 4)),
              ElementsAre(HasSubstr("link 1 would have 11 kg instead of 1")));
  EXPECT_THAT(masses_beyond_belief(arm(1, 4), arm(1, 0.3)),
              ElementsAre(HasSubstr("link 2 would have 0.3 kg instead of 4")));
}

// A flange of the file may come to hold a tool, but none that outweighs the arm.
TEST(MassesBeyondBelief,
     GIVEN_next_to_nothing_in_the_file_THEN_it_may_grow_to_what_the_arm_weighs) {
  EXPECT_THAT(masses_beyond_belief(arm(5, 0.05), arm(5, 4)), IsEmpty());
  EXPECT_THAT(masses_beyond_belief(arm(5, 0.05), arm(5, 6)), ElementsAre(HasSubstr("link 2")));
}

TEST(MassesBeyondBelief, GIVEN_a_payload_as_an_effect_of_the_file_THEN_it_counts_with_its_link) {
  RobotDescription file = arm(1, 0.2);
  desk::RobotEffect payload;
  payload.kind = EffectKind::kLinkMass;
  payload.joint = 1;
  payload.parameters[0] = 1.8;
  file.effects.push_back(payload);
  EXPECT_THAT(masses_beyond_belief(file, arm(1, 3)), IsEmpty());
}

}  // namespace
}  // namespace offnominal::test
