// What has changed between recordings of one robot, or since a time that is known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "changed_arm.hpp"
#include "common/error.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "report/page.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using test::number;
using test::with;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kJoints = 4;

ExplainOptions after(std::size_t first) {
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.replays = 0;
  options.threads = 2;
  options.after = first;
  return options;
}

// Along a motion of its own.
Log recorded(const RobotDescription& robot, const std::string& name, std::uint64_t seed) {
  Log log = test::record(robot, {.duration_s = 15, .seed = seed});
  log.file = name;
  return log;
}

TEST(KnownChange, OfThePayloadBetweenRecordingsIsToldWithItsMass) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription loaded =
      with(robot, test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.5, 0.05, -0.03, 0.06}));
  const Explanation told =
      explain(robot, {recorded(robot, "a", 1), recorded(loaded, "b", 2), recorded(loaded, "c", 3)},
              {}, after(1));
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  const Change& change = told.changes[0];
  EXPECT_EQ(change.what, (EffectAt{EffectKind::kTipPayload, kJoints - 1}));
  EXPECT_NEAR(number(change, "mass"), 0.5, 0.05);
  EXPECT_TRUE(change.is_between);
  EXPECT_EQ(change.recording, 1U);
  EXPECT_FALSE(change.at_ci95_s);
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  EXPECT_EQ(told.verdict, Verdict::kChanged) << told.words;
  EXPECT_THAT(told.words, HasSubstr("tip_payload on joint 4 from before to after (mass +0.5"));
}

// An unknown torque over the position is another one in another area, whatever step takes as much.
TEST(KnownChange, IsNotToldWhereTheLaterMotionIsElsewhere) {
  const RobotDescription robot = test::serial_arm(1);
  const auto moved_by = [&](double away, const std::string& name, std::uint64_t seed) {
    Log log = recorded(robot, name, seed);
    log.q.col(0).array() += away;
    log.tau.col(0).array() += 0.8 * (3 * (log.q.col(0).array() - 1.5)).tanh();
    return log;
  };
  const Explanation told = explain(robot, {moved_by(0, "a", 1), moved_by(3, "b", 2)}, {}, after(1));
  EXPECT_THAT(told.changes, IsEmpty()) << told.words;
}

// What is missing before and after is found; what differs is told beside it.
TEST(KnownChange, OfFrictionIsToldBesideAnEffectThatIsMissingInBoth) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription before =
      with(robot, test::effect_of(EffectKind::kJointStiffness, 2, {5, 0.1}));
  const RobotDescription worn =
      with(before, test::effect_of(EffectKind::kCoulombFriction, 1, {0.8, 0.01}));
  const Explanation told =
      explain(robot, {recorded(before, "a", 1), recorded(worn, "b", 2)}, {}, after(1));
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.changes[0].what, (EffectAt{EffectKind::kCoulombFriction, 1}));
  EXPECT_NEAR(number(told.changes[0], "level"), 0.8, 0.1);
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kJointStiffness, 2}));
}

// What comes after may be short: a run that the fault has ended.
TEST(KnownChange, IsToldOfThreeSecondsBehindIt) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription worn =
      with(robot, test::effect_of(EffectKind::kCoulombFriction, 1, {2, 0.01}));
  Log after_it = test::record(worn, {.duration_s = 3, .seed = 2});
  after_it.file = "b";
  const Explanation told = explain(robot, {recorded(robot, "a", 1), after_it}, {}, after(1));
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.changes[0].what, (EffectAt{EffectKind::kCoulombFriction, 1}));
  EXPECT_NEAR(number(told.changes[0], "level"), 2, 0.2);
}

// Each joint by itself could have another torque constant; a body explains both.
TEST(KnownChange, OfAPayloadAtTheTipIsNoChangeOfTorqueConstants) {
  const RobotDescription robot = test::serial_arm(2);
  const RobotDescription loaded =
      with(robot, test::effect_of(EffectKind::kTipPayload, 1, {0.5, 0.2, 0, 0}));
  const Explanation told =
      explain(robot, {recorded(robot, "a", 1), recorded(loaded, "b", 2)}, {}, after(1));
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.changes[0].what, (EffectAt{EffectKind::kTipPayload, 1}));
  EXPECT_NEAR(number(told.changes[0], "mass"), 0.5, 0.1);
}

TEST(KnownChange, IsNoneBetweenTwoMotionsOfOneRobot) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription same =
      with(robot, test::effect_of(EffectKind::kJointStiffness, 1, {5, 0.1}));
  const Explanation told =
      explain(robot, {recorded(same, "a", 4), recorded(same, "b", 5)}, {}, after(1));
  EXPECT_THAT(told.changes, IsEmpty()) << told.words;
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_THAT(told.words, HasSubstr("No change is told there"));
}

// From then on the torques are those of another robot.
TEST(KnownChange, SinceATimeIsToldAtThatTime) {
  constexpr double kSinceS = 9;
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription other =
      with(robot, test::effect_of(EffectKind::kViscousFriction, 2, {0.6}));
  Log log = recorded(robot, "a", 7);
  const Log behind = recorded(other, "a", 7);
  for (Index i = 0; i < log.t_s.size(); ++i) {
    if (log.t_s[i] >= kSinceS) log.tau.row(i) = behind.tau.row(i);
  }
  ExplainOptions options = after(0);
  options.since_s = kSinceS;
  const Explanation told = explain(robot, {log}, {}, options);
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  const Change& change = told.changes[0];
  EXPECT_EQ(change.what, (EffectAt{EffectKind::kViscousFriction, 2}));
  EXPECT_EQ(change.at_s, kSinceS);
  EXPECT_FALSE(change.is_between);
  EXPECT_FALSE(change.at_ci95_s);
  EXPECT_THAT(told.words, HasSubstr("from 9.00 s of recording 1 on"));
}

TEST(KnownChange, IsSaidInTextAndJson) {
  const RobotDescription robot = test::serial_arm(2);
  const RobotDescription other =
      with(robot, test::effect_of(EffectKind::kCoulombFriction, 1, {0.8, 0.01}));
  const Explanation told =
      explain(robot, {recorded(robot, "a", 1), recorded(other, "b", 2)}, {}, after(1));
  ExplainNames names{{"a", "b"}, {}, "robot", "explain"};
  names.after = {"b"};
  EXPECT_THAT(text_of(told, names),
              HasSubstr("from before to after: coulomb_friction on joint 2 changes by"));
  EXPECT_THAT(told.advice, Contains(HasSubstr("of two robots")));
  EXPECT_THAT(report::render(page_of(told, names)), HasSubstr("coulomb_friction"));
  const nlohmann::ordered_json json = to_json(told, names);
  EXPECT_EQ(json.at("after"), nlohmann::ordered_json({"b"}));
  ASSERT_THAT(json.at("changes"), SizeIs(1));
  const nlohmann::ordered_json& change = json.at("changes")[0];
  EXPECT_EQ(change.at("between"), true);
  EXPECT_EQ(change.at("recording"), 2);
  EXPECT_TRUE(change.at("at_s").is_null());
  EXPECT_TRUE(change.at("at_s_ci95").is_null());
}

std::string refusal(const std::vector<Log>& logs, const ExplainOptions& options) {
  try {
    static_cast<void>(explain(test::serial_arm(2), logs, {}, options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(KnownChange, RefusesWhatCannotBe) {
  const RobotDescription robot = test::serial_arm(2);
  const Log a = recorded(robot, "a", 1);
  const Log b = recorded(robot, "b", 2);
  EXPECT_THAT(refusal({a, b}, after(2)), HasSubstr("--after: found nothing"));
  EXPECT_THAT(refusal({a, a}, after(1)), HasSubstr("--after: found a, which is before too"));
  ExplainOptions since = after(0);
  since.since_s = 15;
  EXPECT_THAT(refusal({a}, since), HasSubstr("--since: found 15 s"));
  EXPECT_THAT(refusal({a}, since), HasSubstr("between 0 and 15 s"));
  since.since_s = 3;
  EXPECT_THAT(refusal({a, b}, since), HasSubstr("--since: found 2 recordings"));
}

}  // namespace
}  // namespace offnominal::desk
