// How an answer is judged, joint by joint.
#include "arm_judge.hpp"

#include <gtest/gtest.h>

namespace offnominal::test {
namespace {

using bench::arm_score_of;
using bench::ArmScore;
using bench::ArmTrueEffect;
using bench::ArmTruth;
using desk::EffectAt;
using desk::Explanation;

constexpr auto kCoulomb = EffectKind::kCoulombFriction;
constexpr auto kViscous = EffectKind::kViscousFriction;

ArmTrueEffect there(EffectKind kind, Eigen::Index joint, bool is_asked_for = true) {
  return {{kind, joint, {{"mass", 2.0}}, 0}, 1, 0.1, is_asked_for};
}

// Six joints, nothing hidden.
ArmTruth nothing() {
  ArmTruth truth;
  truth.stands.assign(6, false);
  truth.torque_constant_error.assign(6, 0.0);
  truth.link_mass_error_share.assign(6, 0.0);
  return truth;
}

desk::Finding finding(EffectKind kind, Eigen::Index joint) {
  desk::Finding one;
  one.what = {kind, joint};
  return one;
}

desk::Finding heavier(EffectKind kind, Eigen::Index joint, double mass) {
  desk::Finding one = finding(kind, joint);
  one.parameters.emplace_back();
  one.parameters.back().value.name = "mass";
  one.parameters.back().value.value = mass;
  return one;
}

TEST(ArmScore, AsksForEveryMissingEffectOfAJoint) {
  ArmTruth truth = nothing();
  truth.effects = {there(kCoulomb, 2), there(kViscous, 2), there(kCoulomb, 4),
                   there(kViscous, 5, false)};
  Explanation told;
  told.found = {finding(kCoulomb, 2), finding(kCoulomb, 4)};
  ArmScore score = arm_score_of(truth, told);
  EXPECT_TRUE(score.joints[2].is_asked);
  EXPECT_FALSE(score.joints[2].is_answered);
  EXPECT_TRUE(score.joints[4].is_answered);
  EXPECT_FALSE(score.joints[5].is_asked);
  EXPECT_TRUE(score.wrong.empty());
  told.found.push_back(finding(kViscous, 2));
  EXPECT_TRUE(arm_score_of(truth, told).joints[2].is_answered);
}

TEST(ArmScore, TakesAClassOfThreeAndNoneOfFour) {
  ArmTruth truth = nothing();
  truth.effects = {there(kCoulomb, 1)};
  Explanation told;
  told.ambiguous = {{{EffectKind::kHysteresis, 1}, {kCoulomb, 1}, {kViscous, 1}}};
  ArmScore score = arm_score_of(truth, told);
  EXPECT_TRUE(score.joints[1].is_answered);
  EXPECT_EQ(score.asked.front().class_size, 3);
  EXPECT_FALSE(score.asked.front().named);
  told.ambiguous.front().push_back({EffectKind::kTorqueOffset, 1});
  score = arm_score_of(truth, told);
  EXPECT_FALSE(score.joints[1].is_answered);
  EXPECT_FALSE(score.joints[1].is_wrong);
}

TEST(ArmScore, CountsWhatIsNotThereAgainstItsJoint) {
  ArmTruth truth = nothing();
  truth.effects = {there(kCoulomb, 1)};
  Explanation told;
  told.found = {finding(kCoulomb, 1), finding(EffectKind::kTorqueOffset, 3)};
  told.ambiguous = {{{EffectKind::kHysteresis, 0}, {EffectKind::kBacklash, 0}}};
  const ArmScore score = arm_score_of(truth, told);
  EXPECT_FALSE(score.joints[1].is_wrong);
  EXPECT_TRUE(score.joints[3].is_wrong);
  EXPECT_TRUE(score.joints[0].is_wrong);
  EXPECT_EQ(score.wrong.size(), 2U);
  // Beside a true one in a class it is no claim.
  told.ambiguous = {{{EffectKind::kTorqueOffset, 3}, {kCoulomb, 1}},
                    {{EffectKind::kHysteresis, 0}, {EffectKind::kBacklash, 0}}};
  EXPECT_FALSE(arm_score_of(truth, told).joints[3].is_wrong);
}

TEST(ArmScore, TakesConstantsAndMassesThatAreOffForWhatTheyAre) {
  ArmTruth truth = nothing();
  truth.torque_constant_error[2] = 0.04;
  truth.link_mass_error_share[3] = 0.2;
  Explanation told;
  told.found = {finding(EffectKind::kTorqueScale, 2), heavier(EffectKind::kLinkMass, 3, 0.4)};
  EXPECT_TRUE(arm_score_of(truth, told).wrong.empty());
  told.found = {finding(EffectKind::kTorqueScale, 1), heavier(EffectKind::kLinkMass, 3, -0.4)};
  EXPECT_EQ(arm_score_of(truth, told).wrong.size(), 2U);
}

TEST(ArmScore, WeighsThePayload) {
  ArmTruth truth = nothing();
  truth.effects = {there(EffectKind::kTipPayload, 5)};
  Explanation told;
  EXPECT_EQ(arm_score_of(truth, told).payload, false);
  told.found = {heavier(EffectKind::kTipPayload, 5, 1.85)};
  EXPECT_EQ(arm_score_of(truth, told).payload, true);
  told.found = {heavier(EffectKind::kTipPayload, 5, 1.7)};
  EXPECT_EQ(arm_score_of(truth, told).payload, false);
  EXPECT_EQ(arm_score_of(nothing(), told).payload, std::nullopt);
}

TEST(ArmScore, AsksWhenItBeganAndOnWhichJoint) {
  ArmTruth truth = nothing();
  truth.changes = {there(kCoulomb, 2)};
  truth.changes.front().effect.from_s = 12.5;
  Explanation told;
  EXPECT_EQ(arm_score_of(truth, told).moment, false);
  told.loud = {{2, 0, 12.45, 30}};
  EXPECT_EQ(arm_score_of(truth, told).moment, true);
  told.loud = {{1, 0, 12.45, 30}};
  EXPECT_EQ(arm_score_of(truth, told).moment, false);
  told.loud = {{2, 0, 12.7, 30}};
  EXPECT_EQ(arm_score_of(truth, told).moment, false);

  // A push has a begin and an end, and every joint before its link feels it.
  ArmTruth pushed = nothing();
  pushed.pushes = {{4.0, 4.5, 3, {1, 0, 0}, {0, 0, 0}}};
  told.loud = {{1, 0, 4.05, 4.45}};
  EXPECT_EQ(arm_score_of(pushed, told).moment, true);
  told.loud = {{1, 0, 4.05, 5.2}};
  EXPECT_EQ(arm_score_of(pushed, told).moment, false);
  told.loud = {{5, 0, 4.05, 4.45}};
  EXPECT_EQ(arm_score_of(pushed, told).moment, false);
}

TEST(ArmScore, AsksForThePushesAndCountsThoseThatAreNone) {
  ArmTruth truth = nothing();
  truth.pushes.emplace_back();
  truth.pushes.front().from_s = 4;
  truth.pushes.front().to_s = 4.5;
  truth.pushes.front().link = 2;
  Explanation told;
  EXPECT_FALSE(*arm_score_of(truth, told).moment);
  told.pushes = {{"a.csv", 4.05, 4.46, {{0, 3, "N m"}, {2, 1, "N m"}}, 4, 4.5}};
  ArmScore score = arm_score_of(truth, told);
  EXPECT_TRUE(*score.moment);
  EXPECT_EQ(score.false_pushes, 0);
  told.pushes.push_back({"a.csv", 4.4, 5, {{1, 3, "N m"}}, 4.4, 5});
  score = arm_score_of(truth, told);
  EXPECT_EQ(score.false_pushes, 1);
  EXPECT_TRUE(score.joints[1].is_wrong);
  EXPECT_FALSE(score.joints[0].is_wrong);
}

}  // namespace
}  // namespace offnominal::test
