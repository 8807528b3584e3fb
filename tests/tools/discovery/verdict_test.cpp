#include "discovery/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// What a search came to, in one word: of explanations made by hand, where simulated recordings
// would not tell the cases apart.

namespace offnominal::tools::discovery {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// One joint on which nothing was found, and what is left of its error.
Explanation nothing_found(double left_to_noise) {
  Explanation e;
  JointErrors joint;
  joint.unit = "N m";
  joint.rms_torque = 10;
  joint.noise_floor = 0.2;
  joint.rms_after = left_to_noise * joint.noise_floor;
  e.joints = {joint};
  e.excitation.resize(1);
  e.excitation[0].sufficient = true;
  Rejection rejected;
  rejected.what = {EffectKind::kTimeDelay, 0};
  rejected.smallest_detectable = 0.05;
  e.rejected.push_back(rejected);
  return e;
}

// The same with a delay that is likely more than chance.
Explanation suspicious(double left_to_noise) {
  Explanation e = nothing_found(left_to_noise);
  e.suspected = {{EffectKind::kTimeDelay, 0}, 0.003, 0.04};
  return e;
}

TEST(Verdict, OfNoiseAloneSaysWhatWouldNotHaveBeenSeen) {
  Explanation e = nothing_found(1.1);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained);
  EXPECT_THAT(e.words, HasSubstr("No effect below 0.5 % of a joint's torque can be named"));
}

TEST(Verdict, OfJointsThatShowMoreAndLessSaysBoth) {
  Explanation e = nothing_found(1.1);
  e.joints.push_back(e.joints[0]);
  e.joints[1].joint = 1;
  e.rejected.push_back(e.rejected[0]);
  e.rejected[1].what.joint = 1;
  e.rejected[1].smallest_detectable = 0.12;
  judge_whole(e);
  EXPECT_THAT(e.words, HasSubstr("No effect below 0.5 to 1.2 % of"));
}

TEST(Verdict, OfAJointWithoutTorqueSaysNoShareOfIt) {
  Explanation e = nothing_found(1.1);
  e.joints[0].rms_torque = 0;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained);
  EXPECT_THAT(e.words, Not(HasSubstr("can be named")));
}

TEST(Verdict, OfNoiseThatIsUnlikelyIsUndecidedAndAdvisesTheMotion) {
  Explanation e = suspicious(1.1);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kNotExcited);
  EXPECT_THAT(e.words, HasSubstr("time_delay on joint 1 would explain 4 %"));
  EXPECT_THAT(e.words, HasSubstr("p = 0.003"));
  EXPECT_THAT(e.advice, ElementsAre(HasSubstr("--excite time_delay@1")));
  EXPECT_TRUE(e.suspected);
}

TEST(Verdict, OfAHoldMapAdvisesMorePositions) {
  Explanation e = suspicious(1.1);
  e.at_rest = true;
  judge_whole(e);
  EXPECT_THAT(e.advice, ElementsAre(HasSubstr("hold it at more positions")));
}

TEST(Verdict, OfAPoorMotionSuspectsNothing) {
  Explanation e = suspicious(1.1);
  e.excitation[0].sufficient = false;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kNotExcited);
  EXPECT_FALSE(e.suspected);
}

TEST(Verdict, OfARestThatStandsAboveTheNoiseSaysSoWhateverIsSuspected) {
  Explanation e = suspicious(2);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained);
  EXPECT_THAT(e.words, HasSubstr("2.0 times above the noise"));
  EXPECT_FALSE(e.suspected);
}

}  // namespace
}  // namespace offnominal::tools::discovery
