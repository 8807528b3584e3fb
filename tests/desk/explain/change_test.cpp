// What changes in the middle of a recording: the torque of one robot up to a moment, and of another
// one behind it, along one motion.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "changed_arm.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "identify/term.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using test::number;
using test::with;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kJoints = 4;
constexpr double kDurationS = 20;
constexpr double kMomentS = 8.7;

ExplainOptions quick(int threads = 2) {
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.replays = 0;
  options.threads = threads;
  return options;
}

Log recorded(const RobotDescription& before, const RobotDescription& behind,
             std::uint64_t seed = 1) {
  const test::SerialRecording settings{.duration_s = kDurationS, .seed = seed};
  Log log = test::record(before, settings);
  const Log other = test::record(behind, settings);
  for (Index i = 0; i < log.t_s.size(); ++i) {
    if (log.t_s[i] >= kMomentS) log.tau.row(i) = other.tau.row(i);
  }
  return log;
}

void expect_at_moment(const Change& change) {
  EXPECT_NEAR(change.at_s, kMomentS, 0.1);
  EXPECT_LE((*change.at_ci95_s)[0], kMomentS + 0.02);
  EXPECT_GE((*change.at_ci95_s)[1], kMomentS - 0.02);
  EXPECT_LT((*change.at_ci95_s)[1] - (*change.at_ci95_s)[0], 1);
}

TEST(Change, OfWhatIsCarriedIsToldWithItsMassAndItsMoment) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription loaded =
      with(robot, test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.5, 0.05, -0.03, 0.06}));
  const Explanation told = explain(robot, {recorded(robot, loaded)}, {}, quick());
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  const Change& change = told.changes[0];
  EXPECT_EQ(change.what, (EffectAt{EffectKind::kTipPayload, kJoints - 1}));
  EXPECT_NEAR(number(change, "mass"), 0.5, 0.05);
  expect_at_moment(change);
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  EXPECT_EQ(told.verdict, Verdict::kChanged) << told.words;
}

// What is put down is a payload of less mass behind that moment.
TEST(Change, OfWhatIsPutDownHasAMassBelowZero) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription loaded =
      with(robot, test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.5, 0.05, -0.03, 0.06}));
  const Explanation told = explain(robot, {recorded(loaded, robot)}, {}, quick());
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.changes[0].what, (EffectAt{EffectKind::kTipPayload, kJoints - 1}));
  EXPECT_NEAR(number(told.changes[0], "mass"), -0.5, 0.05);
}

struct Made {
  EffectKind kind = EffectKind::kCoulombFriction;
  std::array<double, kMaxEffectParameters> parameters{};
  std::string number;
  double value = 0;
};

class ChangeOfADrive : public ::testing::TestWithParam<Made> {};

TEST_P(ChangeOfADrive, IsToldWithItsJointItsSizeAndItsMoment) {
  constexpr int kJoint = 1;
  const Made& made = GetParam();
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription other = with(robot, test::effect_of(made.kind, kJoint, made.parameters));
  const Explanation told = explain(robot, {recorded(robot, other, 5)}, {}, quick());
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  const Change& change = told.changes[0];
  EXPECT_EQ(change.what, (EffectAt{made.kind, kJoint}));
  EXPECT_NEAR(number(change, made.number), made.value, 0.2 * std::abs(made.value));
  expect_at_moment(change);
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  const JointAnswer& answer = *std::find_if(told.answers.begin(), told.answers.end(),
                                            [](const auto& one) { return one.joint == kJoint; });
  EXPECT_EQ(answer.verdict, Verdict::kChanged) << answer.words;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ChangeOfADrive,
    ::testing::Values(Made{EffectKind::kCoulombFriction, {0.8, 0.01}, "level", 0.8},
                      Made{EffectKind::kViscousFriction, {0.6}, "coefficient", 0.6},
                      Made{EffectKind::kTorqueOffset, {0.7}, "level", 0.7},
                      Made{EffectKind::kTorqueScale, {-0.2}, "error", -0.2}),
    [](const auto& parameter) { return std::string(info_of(parameter.param.kind)->name); });

TEST(Change, BesideAnEffectThatIsMissingAllTheTimeLeavesItsName) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription before =
      with(robot, test::effect_of(EffectKind::kJointStiffness, 2, {5, 0.1}));
  const RobotDescription behind =
      with(before, test::effect_of(EffectKind::kCoulombFriction, 1, {0.8, 0.01}));
  const Explanation told = explain(robot, {recorded(before, behind)}, {}, quick());
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.changes[0].what, (EffectAt{EffectKind::kCoulombFriction, 1}));
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kJointStiffness, 2}));
  EXPECT_EQ(told.verdict, Verdict::kFound);
  EXPECT_THAT(told.words, HasSubstr("changes in the middle"));
}

TEST(Change, IsNotToldWhereNothingChanges) {
  const RobotDescription robot = test::serial_arm(kJoints);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Explanation told = explain(robot, {recorded(robot, robot, seed)}, {}, quick());
    EXPECT_THAT(told.changes, IsEmpty()) << told.words;
    EXPECT_EQ(told.verdict, Verdict::kExplained) << told.words;
  }
}

// Friction that falls while the joint warms up has no moment.
TEST(Change, IsNotToldOfADrift) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription warming =
      with(robot, test::effect_of(EffectKind::kTemperatureDrift, 1, {0.8, 0.0, 6.0, 0.01}));
  const Explanation told = explain(robot, {recorded(warming, warming)}, {}, quick());
  EXPECT_THAT(told.changes, IsEmpty()) << told.words;
}

// An unknown torque over the position is another one where the joint moves elsewhere.
TEST(Change, IsNotToldWhereOnlyTheMotionIsAnother) {
  const RobotDescription robot = test::serial_arm(1);
  Log log = test::record(robot, {.duration_s = kDurationS, .seed = 4});
  // From the middle on about another position: the same velocities.
  for (Index i = 0; i < log.t_s.size(); ++i) {
    const double move = std::clamp(2 * (log.t_s[i] - kMomentS), 0.0, 3.0);
    log.q(i, 0) += move;
    log.tau(i, 0) += 0.8 * std::tanh(3 * (log.q(i, 0) - 1.5));
  }
  const Explanation told = explain(robot, {log}, {}, quick());
  EXPECT_THAT(told.changes, IsEmpty()) << told.words;
}

// ... however fast it fades.
TEST(Change, IsNotToldOfAFastDrift) {
  const RobotDescription robot = test::serial_arm(2);
  const RobotDescription warming =
      with(robot, test::effect_of(EffectKind::kTemperatureDrift, 1, {0.8, 0.0, 1.2, 0.01}));
  const Log log = test::record(warming, {.duration_s = 30, .seed = 6});
  const Explanation told = explain(robot, {log}, {}, quick());
  EXPECT_THAT(told.changes, IsEmpty()) << told.words;
}

TEST(Change, ThatGoesAgainIsOneFromAMomentToAnother) {
  constexpr double kGoneS = 13.4;
  const RobotDescription robot = test::serial_arm(kJoints);
  const RobotDescription loaded =
      with(robot, test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.5, 0.05, -0.03, 0.06}));
  Log log = recorded(robot, loaded);
  const Log after = recorded(robot, robot);
  for (Index i = 0; i < log.t_s.size(); ++i) {
    if (log.t_s[i] >= kGoneS) log.tau.row(i) = after.tau.row(i);
  }
  const Explanation told = explain(robot, {log}, {}, quick());
  ASSERT_THAT(told.changes, SizeIs(1)) << told.words;
  const Change& change = told.changes[0];
  EXPECT_EQ(change.what, (EffectAt{EffectKind::kTipPayload, kJoints - 1}));
  EXPECT_NEAR(number(change, "mass"), 0.5, 0.05);
  EXPECT_NEAR(change.at_s, kMomentS, 0.1);
  ASSERT_TRUE(change.until_s);
  EXPECT_NEAR(*change.until_s, kGoneS, 0.1);
  EXPECT_THAT(told.words, HasSubstr("to 13.4"));
}

TEST(Change, IsTheSameForAnyNumberOfThreads) {
  const RobotDescription robot = test::serial_arm(2);
  const RobotDescription other =
      with(robot, test::effect_of(EffectKind::kCoulombFriction, 1, {0.8, 0.01}));
  const ExplainNames names{{"log"}, {}, "robot", "explain"};
  const Explanation one = explain(robot, {recorded(robot, other)}, {}, quick(1));
  const Explanation two = explain(robot, {recorded(robot, other)}, {}, quick(2));
  ASSERT_THAT(one.changes, SizeIs(1)) << one.words;
  EXPECT_EQ(to_json(one, names).dump(), to_json(two, names).dump());
}

TEST(Change, IsSaidInTextAndJson) {
  const RobotDescription robot = test::serial_arm(2);
  const RobotDescription other =
      with(robot, test::effect_of(EffectKind::kCoulombFriction, 1, {0.8, 0.01}));
  const Explanation told = explain(robot, {recorded(robot, other)}, {}, quick());
  const ExplainNames names{{"log"}, {}, "robot", "explain"};
  EXPECT_THAT(text_of(told, names),
              HasSubstr("of recording 1 on: coulomb_friction on joint 2 changes by"));
  const nlohmann::ordered_json changes = to_json(told, names).at("changes");
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].at("effect"), "coulomb_friction");
  EXPECT_EQ(changes[0].at("joint"), 2);
  EXPECT_EQ(changes[0].at("recording"), 1);
  EXPECT_NEAR(changes[0].at("at_s").get<double>(), kMomentS, 0.1);
  EXPECT_NEAR(changes[0].at("by").at("level").at("value").get<double>(), 0.8, 0.1);
  EXPECT_THAT(told.advice, ::testing::Contains(HasSubstr("cut it there")));
}

TEST(TimeSpan, IsOneInItsPartOfItsRecordingAndNothingElsewhere) {
  const RobotDescription robot = test::serial_arm(2);
  std::vector<Log> logs{test::record(robot, {.duration_s = 6}),
                        test::record(robot, {.duration_s = 6, .seed = 2})};
  logs[0].file = "first";
  logs[1].file = "second";
  const FilterPlan plan = plan_filter(logs, robot);
  const std::vector<Workspace> recordings =
      make_workspaces(logs, robot, plan, Eigen::VectorXd::Zero(2));
  const RowLayout layout(recordings);
  const Eigen::MatrixXd rows = within(shares_of({{"second"}, 2, 4}, recordings), layout,
                                      Eigen::MatrixXd::Ones(layout.rows(), 1));
  constexpr double kSlopeS = 0.1;
  for (std::size_t r = 0; r < 2; ++r) {
    const Eigen::VectorXd t_s = kept_samples(recordings[r].plan, recordings[r].motion.t_s);
    for (Index joint = 0; joint < 2; ++joint) {
      for (Index i = 0; i < t_s.size(); ++i) {
        if (std::min(std::abs(t_s[i] - 2), std::abs(t_s[i] - 4)) < kSlopeS) continue;
        const bool inside = r == 1 && t_s[i] >= 2 && t_s[i] < 4;
        EXPECT_NEAR(rows(layout.begin(r, joint) + i, 0), inside ? 1 : 0, 0.1) << t_s[i];
      }
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
