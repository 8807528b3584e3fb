#include "explain/verdict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "explain/doubts.hpp"
#include "explain/explain_report.hpp"

// What a search came to, in one word: of explanations made by hand, where simulated recordings
// would not tell the cases apart.

namespace offnominal::desk {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
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
  e.excitation[0].moves = true;
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

TEST(Verdict, SaysNothingOfWhatNoRecordingWouldShow) {
  Explanation e = nothing_found(1.1);
  e.rejected.push_back(e.rejected[0]);
  e.rejected[1].smallest_detectable = std::numeric_limits<double>::infinity();
  judge_whole(e);
  EXPECT_THAT(e.words, HasSubstr("No effect below 0.5 % of a joint's torque can be named"));
}

TEST(Verdict, OfAJointOfWhichNothingIsLeftSaysSo) {
  Explanation e = nothing_found(1.1);
  e.joints.push_back(e.joints[0]);
  e.joints[1].joint = 1;
  e.joints[1].rms_torque = std::numeric_limits<double>::quiet_NaN();
  e.excitation.resize(2, e.excitation[0]);
  judge_whole(e);
  EXPECT_EQ(e.answers[1].joint, 1);
  EXPECT_EQ(e.answers[1].verdict, Verdict::kNotExcited);
  EXPECT_THAT(e.answers[1].words, HasSubstr("nothing is left of its recordings"));
  EXPECT_THAT(text_of(e, {{"log"}, {}, "robot", ""}), Not(HasSubstr("nan")));
}

// GIVEN a joint that stands with a third of its torque unexplained beside one whose unknown part is
// a hundredth of its own THEN the sentence begins with what is largest.
TEST(Verdict, OfAJointThatIsHeldAgainstItsModelSaysSoFirst) {
  Explanation e = nothing_found(5);
  e.where = {{0, "position", 0.7}};
  e.joints[0].rms_before = 0.1;
  e.joints.push_back(e.joints[0]);
  e.joints[1].joint = 1;
  e.joints[1].rms_before = 3.3;
  e.excitation.push_back({});
  e.improved.joints.resize(2);
  judge_whole(e);
  EXPECT_THAT(e.words,
              ::testing::StartsWith("The largest error is that of joint 2, 3.3 N m or 33 %"));
  EXPECT_THAT(e.words, HasSubstr("Something acts on joint 1"));
  e.joints[1].rms_before = 0.2;
  judge_whole(e);
  EXPECT_THAT(e.words, ::testing::StartsWith("Something acts on joint 1"));
}

TEST(Verdict, OffersNoCurveToAFileThatHasOne) {
  Explanation e = nothing_found(5);
  e.where = {{0, "position", 0.7}};
  e.improved.joints.resize(1);
  judge_whole(e);
  EXPECT_THAT(e.advice, Contains(HasSubstr("add position_torque")));
  RobotEffect curve;
  curve.kind = EffectKind::kPositionTorque;
  e.improved.effects = {curve};
  judge_whole(e);
  EXPECT_THAT(e.advice, Not(Contains(HasSubstr("add position_torque"))));
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

// What shows and cannot be told from the model's own numbers is neither explained nor unknown.
TEST(Verdict, OfWhatIsNotToldFromTheModelsOwnNumbersIsNotExcited) {
  Explanation e = nothing_found(5);
  e.where = {{0, "velocity", 0.7}};
  e.unsure = {0};
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kNotExcited) << e.words;
  EXPECT_THAT(e.answers[0].words, HasSubstr("do not tell it from the model's own numbers"));
}

// A motion that would not show small friction hides nothing that stands out.
TEST(Verdict, OfARestThatFollowsAVariableIsUnknownWhateverTheMotionWouldNotShow) {
  Explanation e = nothing_found(5);
  e.where = {{0, "velocity", 0.7}};
  e.excitation[0].sufficient = false;
  e.excitation[0].lack = "coulomb_friction would not show in these recordings";
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kUnknownStateDependent) << e.words;
}

TEST(Verdict, OfARestThatStandsAboveTheNoiseSaysSoWhateverIsSuspected) {
  Explanation e = suspicious(2);
  e.joints[0].rms_torque = 100;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained);
  EXPECT_THAT(e.words, HasSubstr("2.0 times above the noise"));
  EXPECT_FALSE(e.suspected);
}

// Coulomb friction on the only joint, and what is left beside it.
Explanation found_with_rest(double left_to_noise) {
  Explanation e = nothing_found(left_to_noise);
  e.joints[0].rms_before = 8;
  e.joints[0].rms_fitted_before = 8;
  Finding finding;
  finding.what = {EffectKind::kCoulombFriction, 0};
  finding.words = "dry friction";
  finding.holdout_before = 8;
  finding.holdout_after = 4;
  e.found = {finding};
  e.where = {{0, "position and velocity", 0.6}};
  return e;
}

TEST(CommandToAdd, HasWhatTheUserKeptAndHowFarLinksAreOff) {
  Explanation e = found_with_rest(1.1);
  judge_whole(e);
  ExplainNames names{{"log"}, {}, "robot", ""};
  names.keep = {keep_fault_of("2:saturation"), keep_fault_of("all:gaps")};
  names.link_share = 0.2;
  EXPECT_THAT(text_of(e, names), HasSubstr("--keep 2:saturation --keep all:gaps --link-share 0.2"));
}

// What `add` would refuse is said before somebody waits for it.
TEST(CommandToAdd, SaysWhatAddWillDoubt) {
  Explanation e = found_with_rest(1.1);
  e.joints[0].holdout_before = 8;
  e.joints[0].holdout_after = 4;
  judge_whole(e);
  const ExplainNames names{{"log"}, {}, "robot", ""};
  EXPECT_THAT(text_of(e, names), AllOf(HasSubstr("add --all-found"), Not(HasSubstr("--force"))));
  JointErrors other = e.joints[0];
  other.joint = 1;
  other.holdout_after = 9;
  e.joints.push_back(other);
  EXPECT_THAT(text_of(e, names),
              AllOf(HasSubstr("add --all-found"), HasSubstr("error of joint 2 rises, by 12.5 %"),
                    HasSubstr("only with --force")));
  EXPECT_EQ(to_json(e, names)["doubts"].size(), 1U);
  EXPECT_THAT(findings_text(e, names), Not(HasSubstr("add --all-found")));
}

// What was found there stands in a class, and is not written.
TEST(CommandToAdd, DoubtsNoJointThatLosesLittleAndThatItLeavesAsItIs) {
  Explanation e = found_with_rest(1.1);
  e.joints[0].holdout_before = 8;
  e.joints[0].holdout_after = 4;
  JointErrors other = e.joints[0];
  other.joint = 1;
  other.holdout_after = 8.01;
  e.joints.push_back(other);
  Finding undecided;
  undecided.what = {EffectKind::kCoulombFriction, 1};
  e.found.push_back(undecided);
  EXPECT_EQ(doubts_of(e, held_out_squares(e)).size(), 1U) << "it is to be written";
  e.ambiguous.push_back({undecided.what, {EffectKind::kHysteresis, 1}});
  EXPECT_TRUE(doubts_of(e, held_out_squares(e)).empty());
}

TEST(Doubted, IsAJointThatIsChangedAndDoesNotGainOrAnotherThatLoses) {
  EXPECT_FALSE(is_doubted({1.0, 0.9, 100}, true));
  EXPECT_TRUE(is_doubted({1.0, 1.0, 100}, true));
  EXPECT_FALSE(is_doubted({1.0, 1.1, 100}, false));
  EXPECT_TRUE(is_doubted({1.0, 1.2, 100}, false));
  // Next to nothing of the torque is no loss.
  EXPECT_FALSE(is_doubted({1.0, 1.2, 1000}, false));
}

TEST(Verdict, SaysWhyTheLinksStayAsTheFileHasThem) {
  Explanation e = found_with_rest(1.1);
  e.links_kept_for = {1};
  e.link_share = 0.05;
  judge_whole(e);
  const ExplainNames names{{"log"}, {}, "robot", ""};
  EXPECT_THAT(text_of(e, names),
              AllOf(HasSubstr("links stay as the robot file has them"),
                    HasSubstr("error of joint 2"), HasSubstr("--link-share 0.05")));
  EXPECT_EQ(to_json(e, names)["links_kept_for"].dump(), "[2]");
}

TEST(CommandToAdd, IsNotThereWhereAddWouldRefuseWhatNoPhysicsHas) {
  Explanation e = found_with_rest(1.1);
  e.unphysical = {"link 1 would have 90 kg instead of 3"};
  judge_whole(e);
  EXPECT_THAT(text_of(e, {{"log"}, {}, "robot", ""}), Not(HasSubstr("add --all-found")));
}

// On a real arm the rest is always far above the sensor's noise: it is told, and deletes nothing.
TEST(Verdict, OfWhatWasFoundStaysFoundWhateverIsLeft) {
  Explanation e = found_with_rest(20);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kFound);
  ASSERT_EQ(e.found.size(), 1U);
  EXPECT_THAT(e.advice,
              Contains(AllOf(HasSubstr("joint 1: what is left, 4 N m"),
                             HasSubstr("40 % of the torque"), HasSubstr("20.0 times the noise"),
                             HasSubstr("follows its position and velocity by 60 %"))));
}

TEST(Verdict, IsGivenForEveryJointTheWorstFirst) {
  Explanation e = found_with_rest(1.1);
  e.joints[0].rms_before = 1;
  JointErrors other = e.joints[0];
  other.joint = 1;
  other.rms_before = 5;
  other.rms_after = 3;
  e.joints.push_back(other);
  e.excitation.resize(2);
  e.excitation[1].moves = true;
  e.excitation[1].sufficient = true;
  e.where = {{1, "velocity", 0.7}};
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kFound) << e.words;
  ASSERT_EQ(e.answers.size(), 2U);
  EXPECT_EQ(e.answers[0].joint, 1);
  EXPECT_EQ(e.answers[0].verdict, Verdict::kUnknownStateDependent) << e.answers[0].words;
  EXPECT_EQ(e.answers[0].left.follows, "velocity");
  EXPECT_NEAR(e.answers[0].left.times_noise, 15, 1e-9);
  EXPECT_EQ(e.answers[1].joint, 0);
  EXPECT_EQ(e.answers[1].verdict, Verdict::kFound);
  EXPECT_THAT(e.answers[1].found, ElementsAre(EffectAt{EffectKind::kCoulombFriction, 0}));
}

// A joint that tells nothing does not keep the others from their answer.
TEST(Verdict, OfAJointIsNotThatOfAnotherThatStands) {
  Explanation e = found_with_rest(1.1);
  JointErrors standing = e.joints[0];
  standing.joint = 1;
  e.joints.push_back(standing);
  e.excitation.resize(2);
  e.excitation[1].lack = "the joint does not move";
  e.where.clear();
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kFound);
  for (const JointAnswer& one : e.answers) {
    EXPECT_EQ(one.verdict, one.joint == 0 ? Verdict::kFound : Verdict::kNotExcited) << one.words;
  }
}

TEST(Verdict, OfARestOfMoreThanTwoPerCentIsNotExplainedThoughItFollowsNothing) {
  Explanation e = nothing_found(2);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kUnknownExternal) << e.words;
  EXPECT_THAT(e.words, HasSubstr("follows nothing that was looked at"));
}

TEST(Verdict, OfStretchesOfTimeSaysWhen) {
  Explanation e = nothing_found(5);
  e.where = {{0, "time", 0.8}};
  e.loud = {{0, 0, 3.5, 4.5}, {1, 0, 7, 8}};
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kUnknownExternal);
  EXPECT_THAT(e.words, HasSubstr("3.5 to 4.5 s of recording 1"));
  EXPECT_THAT(e.words, Not(HasSubstr("7.0")));
}

TEST(Verdict, OfATorqueOverAVariableSaysHowMuchOfItAnEffectIs) {
  Explanation e = nothing_found(5);
  e.where = {{0, "position", 0.7}};
  e.over_variable = {{0, "position", {{EffectKind::kJointStiffness, 0}}, 0.6, {}, {}}};
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kUnknownStateDependent);
  EXPECT_THAT(e.words, HasSubstr("a torque over position"));
  EXPECT_THAT(e.words, HasSubstr("joint_stiffness is 60 %"));
}

TEST(Verdict, SaysHowFarTheLinksWereLetOffTheFileWhereTheRecordingsSaidSo) {
  Explanation e = found_with_rest(1.1);
  e.link_share = 0.6;
  judge_whole(e);
  EXPECT_THAT(e.advice, Not(Contains(HasSubstr("--link-share"))));
  e.link_share_judged = true;
  judge_whole(e);
  EXPECT_THAT(e.advice, Contains(AllOf(HasSubstr("within 60 %"), HasSubstr("--link-share"))));
}

// Where the recordings say that links are off, and a robot file with others predicts unseen data.
TEST(Verdict, OfLinksThatAreOffIsThatAKnownQuantityHasAnotherValue) {
  Explanation e = nothing_found(1.1);
  e.joints[0].rms_before = 5;
  e.joints[0].holdout_before = 5;
  e.joints[0].holdout_after = 1;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained) << e.words;
  EXPECT_FALSE(changes_the_file(e));
  e.link_share_judged = true;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kParameterShift) << e.words;
  EXPECT_THAT(e.words, HasSubstr("of the links"));
  EXPECT_TRUE(changes_the_file(e));
  // Not where it costs another joint.
  JointErrors other = e.joints[0];
  other.joint = 1;
  other.holdout_after = 6;
  e.joints.push_back(other);
  e.excitation.push_back(e.excitation[0]);
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kExplained) << e.words;
}

// Friction is there beside it.
TEST(Verdict, OfATorqueOverAVariableBesideWhatWasFoundNamesBoth) {
  Explanation e = found_with_rest(5);
  e.over_variable = {{0, "position", {}, 0.4, {}, {}}};
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kFound);
  EXPECT_THAT(e.answers[0].words,
              AllOf(HasSubstr("coulomb_friction"), HasSubstr("a torque over position"),
                    HasSubstr("beside what was found")));
}

// What a change leaves around reversals is no unknown thing of its own, unless it is much.
TEST(Verdict, OfAChangeThatLeavesALittleIsTheChange) {
  Explanation e = nothing_found(4);
  e.where = {{0, "time", 0.6}};
  e.joints[0].rms_torque = 100 * e.joints[0].rms_after;
  Explanation without = e;
  judge_whole(without);
  EXPECT_EQ(without.verdict, Verdict::kUnknownExternal);
  Change change;
  change.what = {EffectKind::kCoulombFriction, 0};
  change.at_s = 30;
  e.changes = {change};
  Explanation much = e;
  judge_whole(e);
  EXPECT_EQ(e.verdict, Verdict::kChanged);
  EXPECT_EQ(e.answers.front().verdict, Verdict::kChanged);
  EXPECT_THAT(e.answers.front().words, HasSubstr("What is left: "));
  much.joints[0].rms_torque = 10 * much.joints[0].rms_after;
  judge_whole(much);
  EXPECT_EQ(much.verdict, Verdict::kUnknownExternal);
}

TEST(Verdict, SaysInOneSentenceThatAFileHasNoFriction) {
  Explanation e = found_with_rest(1.1);
  e.without_friction = {0, 2};
  judge_whole(e);
  EXPECT_THAT(e.advice, Contains(AllOf(HasSubstr("no friction on joints 1, 3"),
                                       HasSubstr("on joint 3 none was found"))));
  e.found.emplace_back().what = {EffectKind::kViscousFriction, 2};
  e.advice.clear();
  judge_whole(e);
  EXPECT_THAT(e.advice, Contains(AllOf(HasSubstr("no friction on joints 1, 3"),
                                       Not(HasSubstr("none was found")))));
}

}  // namespace
}  // namespace offnominal::desk
