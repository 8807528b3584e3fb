// The robot that explain() would write: what was found is in it, and it predicts a recording that
// no fit has seen as well as the search says.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "compare/before_after.hpp"
#include "compare/measurement.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "explain/link_share.hpp"
#include "hidden_case.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using test::case_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Explanation explained(const hidden::Case& made, const RobotDescription& robot) {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.replays = 0;
  options.threads = 2;
  options.source = "a test";
  return explain(robot, {test::to_log(made.recording)}, {test::to_log(made.holdout)}, options);
}

class ImprovedRobotOf : public ::testing::TestWithParam<hidden::HiddenEffect> {};

TEST_P(ImprovedRobotOf, HasTheEffectAndPredictsWhatNoFitHasSeen) {
  const hidden::Case made = case_of(5, {GetParam()});
  const RobotDescription file = test::to_robot(made.nominal);
  const Explanation result = explained(made, file);
  ASSERT_EQ(result.found.size(), 1U) << result.words;
  EXPECT_THAT(result.unwritable, IsEmpty());
  const RobotDescription& improved = result.improved;
  ASSERT_EQ(improved.effects.size(), file.effects.size() + 1);
  const RobotEffect& added = improved.effects.back();
  EXPECT_EQ(std::string(info_of(added.kind)->name), hidden::name(GetParam()));
  EXPECT_TRUE(added.fitted);
  EXPECT_THAT(added.source, HasSubstr("a test"));
  const hidden::TrueEffect& truth = made.truth.effects[0];
  EXPECT_EQ(added.joint, truth.joint);
  EXPECT_NEAR(added.parameters[0], truth.parameters[0].value,
              0.1 * std::abs(truth.parameters[0].value));
  // A robot file can be made of it.
  EXPECT_EQ(robot_text(parse_robot(robot_text(improved), "")), robot_text(improved));

  const Measurement unseen = measure(test::to_log(made.holdout), file);
  const auto gain = before_after(compare(file, unseen), compare(improved, unseen));
  EXPECT_GT(gain[static_cast<std::size_t>(truth.joint)].fall(), 0.5);
  // Explained again with it, nothing is missing.
  const Explanation again = explained(made, improved);
  EXPECT_EQ(again.verdict, Verdict::kExplained) << again.words;
}

INSTANTIATE_TEST_SUITE_P(Some, ImprovedRobotOf,
                         ::testing::Values(hidden::HiddenEffect::kJointStiffness,
                                           hidden::HiddenEffect::kHysteresis,
                                           hidden::HiddenEffect::kTimeDelay),
                         [](const auto& tried) { return std::string(hidden::name(tried.param)); });

// A robot file multiplies everything on the joint by its torque scale, the regression only what the
// file had.
TEST(ImprovedRobot, GIVEN_a_torque_scale_THEN_what_stands_beside_it_is_not_scaled_twice) {
  hidden::Case made = case_of(4215208974, {hidden::HiddenEffect::kJointStiffness});
  const hidden::TrueEffect& truth = made.truth.effects[0];
  constexpr double kWrongGain = 1.5;
  made.recording.tau.col(truth.joint) *= kWrongGain;
  made.holdout.tau.col(truth.joint) *= kWrongGain;
  const Explanation result = explained(made, test::to_robot(made.nominal));
  ASSERT_EQ(result.found.size(), 2U) << result.words;
  ASSERT_EQ(result.found[0].what.name(), "torque_scale");
  ASSERT_EQ(result.found[1].what.name(), "joint_stiffness");
  const double stiffness = truth.parameters[0].value;
  EXPECT_NEAR(result.found[0].parameters[0].value.value, kWrongGain - 1, 0.01);
  EXPECT_NEAR(result.found[1].parameters[0].value.value, stiffness, 0.02 * stiffness);
  const RobotEffect& written = result.improved.effects.back();
  ASSERT_EQ(written.kind, EffectKind::kJointStiffness);
  EXPECT_NEAR(written.parameters[0], stiffness, 0.02 * stiffness);
  const Explanation again = explained(made, result.improved);
  EXPECT_EQ(again.verdict, Verdict::kExplained) << again.words;
}

// Files that are off by 1.5 % of each other come out with the same masses.
TEST(ImprovedRobot, LinksComeOutTheSameFromFilesThatDiffer) {
  const hidden::Case made = case_of(5, {hidden::HiddenEffect::kViscousFriction});
  const RobotDescription file = test::to_robot(made.nominal);
  RobotDescription lighter = file;
  for (RobotJoint& joint : lighter.joints) {
    joint.joint.mass_kg *= 0.985;
    for (double& inertia : joint.joint.inertia_kg_m2) inertia *= 0.985;
  }
  const Explanation a = explained(made, file);
  const Explanation b = explained(made, lighter);
  for (std::size_t link = 0; link < 2; ++link) {
    const double mass = a.improved.joints[link].joint.mass_kg;
    EXPECT_NEAR(b.improved.joints[link].joint.mass_kg, mass, 0.01 * mass) << "link " << link + 1;
  }
}

// What other links gain where they are fitted they lose elsewhere: then they are no better ones.
TEST(ImprovedRobot, HasTheFilesLinksWhereOthersPredictAnotherJointWorse) {
  const hidden::Case made = case_of(5, {hidden::HiddenEffect::kViscousFriction});
  const RobotDescription file = test::to_robot(made.nominal);
  Log heavier = test::to_log(made.recording);
  heavier.tau *= 1.04;
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.replays = 0;
  options.threads = 2;
  const auto told = [&] { return explain(file, {heavier}, {test::to_log(made.holdout)}, options); };
  const Explanation kept = told();
  ASSERT_FALSE(kept.found.empty()) << kept.words;
  EXPECT_FALSE(kept.links_kept_for.empty());
  options.link_share = kUsualLinkShare;
  const Explanation as_asked = told();
  EXPECT_THAT(as_asked.links_kept_for, IsEmpty());
  double furthest = 0;
  for (std::size_t link = 0; link < file.joints.size(); ++link) {
    const double mass = file.joints[link].joint.mass_kg;
    EXPECT_EQ(kept.improved.joints[link].joint.mass_kg, mass);
    furthest = std::max(furthest, as_asked.improved.joints[link].joint.mass_kg / mass - 1);
  }
  EXPECT_GT(furthest, 0.02);
}

// What is between motor and link: files have it, although no on-board monitor can carry it. The
// file's displacement is whole where the search's is linear, so its error is a little another one.
TEST(ImprovedRobot, HasATransmissionThatGivesWayOrHasPlay) {
  for (const auto effect :
       {hidden::HiddenEffect::kBacklash, hidden::HiddenEffect::kJointElasticity}) {
    const hidden::Case made = case_of(5, {effect});
    const RobotDescription file = test::to_robot(made.nominal);
    const Explanation result = explained(made, file);
    ASSERT_EQ(result.found.size(), 1U) << result.words;
    EXPECT_EQ(result.found[0].what.name(), hidden::name(effect));
    EXPECT_THAT(result.unwritable, IsEmpty());
    EXPECT_THAT(result.unphysical, IsEmpty());
    const auto joint = static_cast<std::size_t>(made.truth.effects[0].joint);
    EXPECT_LT(result.joints[joint].rms_improved, 1.6 * result.joints[joint].rms_after)
        << hidden::name(effect);
    EXPECT_LT(result.joints[joint].rms_improved, 0.7 * result.joints[joint].rms_before)
        << hidden::name(effect);
    const Measurement unseen = measure(test::to_log(made.holdout), file);
    const auto gain = before_after(compare(file, unseen), compare(result.improved, unseen));
    EXPECT_GT(gain[joint].fall(), 0.3) << hidden::name(effect);
    const Explanation again = explained(made, result.improved);
    for (const Finding& one : again.found) {
      EXPECT_FALSE(one.what == result.found[0].what) << again.words;
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
