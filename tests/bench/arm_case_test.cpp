// Cases of the benchmark of arms: what an owner would bring, and what is true of it.
#include "arm_case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "arm_groups.hpp"
#include "arm_outcome.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::test {
namespace {

using bench::arm_groups;
using bench::ArmCase;
using bench::ArmGroup;
using bench::ArmHides;
using bench::ArmRequest;
using bench::make_arm_case;

constexpr std::uint64_t kBase = 5;

ArmRequest first_of(ArmHides hides) {
  for (const ArmGroup& group : arm_groups(kBase, true)) {
    if (group.hides == hides) return group.requests.front();
  }
  throw std::logic_error("no such group");
}

TEST(ArmGroups, Are300CasesThatHideSomethingAnd200ThatDoNot) {
  std::size_t hiding = 0;
  std::set<std::uint64_t> seeds;
  for (const ArmGroup& group : arm_groups(kBase, false)) {
    for (const ArmRequest& one : group.requests) seeds.insert(one.seed);
    if (group.hides == ArmHides::kNothing) {
      EXPECT_EQ(group.requests.size(), 200U);
    } else {
      hiding += group.requests.size();
    }
  }
  EXPECT_EQ(hiding, 300U);
  EXPECT_EQ(seeds.size(), 500U);
  std::size_t quick = 0;
  for (const ArmGroup& group : arm_groups(kBase, true)) quick += group.requests.size();
  EXPECT_EQ(quick, 24U);
}

TEST(ArmCase, IsTheSameByteForByteForTheSameSeed) {
  const ArmRequest request = first_of(ArmHides::kPush);
  const ArmCase once = make_arm_case(request);
  const ArmCase again = make_arm_case(request);
  EXPECT_EQ(once.recording, again.recording);
  EXPECT_EQ(once.holdout, again.holdout);
  EXPECT_EQ(desk::robot_text(once.robot), desk::robot_text(again.robot));
  const ArmCase other = make_arm_case({request.hides, request.seed + 1});
  EXPECT_NE(once.recording, other.recording);
}

class ArmCaseOf : public testing::TestWithParam<ArmHides> {};

// GIVEN a robot file and a recording WHEN they are read as files THEN they are what the truth says.
void expect_read_as_files(const ArmCase& made) {
  const TemporaryFolder folder;
  desk::write_robot_file(made.robot, folder / "robot.toml");
  put(folder / "recording.csv", made.recording);
  const desk::RobotDescription robot = desk::read_robot_file(folder / "robot.toml");
  EXPECT_THAT(robot.joint_count(), testing::AnyOf(6, 7));
  const desk::Log log = desk::read_log(folder / "recording.csv", robot);
  EXPECT_NEAR(log.sample_rate_hz(), made.truth.rate_hz, 1e-6 * made.truth.rate_hz);
  EXPECT_NEAR(log.t_s[log.sample_count() - 1], made.truth.duration_s, 0.011);
  for (std::size_t j = 0; j < made.truth.stands.size(); ++j) {
    const auto column = log.q.col(static_cast<Eigen::Index>(j));
    const double range = column.maxCoeff() - column.minCoeff();
    if (made.truth.stands[j]) {
      EXPECT_LT(range, 0.05);
    } else {
      EXPECT_GT(range, 0.1);
    }
  }
}

TEST_P(ArmCaseOf, ItsGroupIsReadAsFilesAndHidesWhatItSays) {
  const ArmCase made = make_arm_case(first_of(GetParam()));
  expect_read_as_files(made);
  const bench::ArmTruth& truth = made.truth;
  const auto& constants = truth.torque_constant_error;
  const bool right_constants =
      std::all_of(constants.begin(), constants.end(), [](double one) { return one == 0; });
  EXPECT_EQ(right_constants, GetParam() == ArmHides::kNothing);
  EXPECT_EQ(truth.changes.size(), GetParam() == ArmHides::kChange ? 1U : 0U);
  EXPECT_EQ(truth.pushes.empty(), GetParam() != ArmHides::kPush);
  switch (GetParam()) {
    case ArmHides::kEffects:
      ASSERT_FALSE(truth.effects.empty());
      EXPECT_TRUE(truth.effects.front().is_asked_for);
      break;
    case ArmHides::kNoFriction:
      EXPECT_TRUE(
          std::all_of(made.robot.effects.begin(), made.robot.effects.end(),
                      [](const auto& one) { return one.kind == EffectKind::kRotorInertia; }));
      EXPECT_EQ(truth.effects.size(), 2 * made.robot.joints.size());
      break;
    case ArmHides::kPayload:
      EXPECT_EQ(truth.effects.front().effect.kind, EffectKind::kTipPayload);
      break;
    case ArmHides::kChange:
      EXPECT_GT(truth.changes.front().effect.from_s, 0.29 * truth.duration_s);
      EXPECT_LT(truth.changes.front().effect.from_s, 0.71 * truth.duration_s);
      break;
    case ArmHides::kPush:
    case ArmHides::kNothing:
      EXPECT_TRUE(truth.effects.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Group, ArmCaseOf,
                         testing::Values(ArmHides::kEffects, ArmHides::kNoFriction,
                                         ArmHides::kPayload, ArmHides::kChange, ArmHides::kPush,
                                         ArmHides::kNothing));

// GIVEN a file without friction WHEN a recording is explained THEN half of what is missing is there
// or more, and the time that it takes is counted.
TEST(ArmBench, FindsTheFrictionThatAFileLacks) {
#ifdef OFFNOMINAL_SANITIZE
  GTEST_SKIP() << "minutes under the sanitizers; the analysis has tests of its own";
#endif
  // What the benchmark takes longer for is how sure of a name the analysis is.
  const bench::ArmOutcome outcome =
      bench::run_arm_case(first_of(ArmHides::kNoFriction), {.replays = 0});
  EXPECT_EQ(outcome.refused, "");
  EXPECT_EQ(outcome.failed, "");
  EXPECT_GT(outcome.time_s, 0);
  const auto asked = static_cast<double>(outcome.score.asked.size());
  ASSERT_GE(asked, 6);
  const auto there = std::count_if(outcome.score.asked.begin(), outcome.score.asked.end(),
                                   [](const auto& one) { return one.class_size > 0; });
  EXPECT_GE(static_cast<double>(there), 0.5 * asked);
}

// Of a case that hides none.
void expect_no_push(const bench::ArmOutcome& outcome) {
  ASSERT_EQ(outcome.refused + outcome.failed, "");
  ASSERT_THAT(outcome.truth.pushes, ::testing::IsEmpty());
  EXPECT_THAT(outcome.score.false_pushes, ::testing::Eq(0));
}

// GIVEN an arm that is in a posture once, and a spring that no file knows WHEN pushes are looked
// for THEN what links of which nothing is known guess there without having seen it is none.
TEST(ArmBench, TakesAPostureThatComesOnceForNoPush) {
#ifdef OFFNOMINAL_SANITIZE
  GTEST_SKIP() << "minutes under the sanitizers; the analysis has tests of its own";
#endif
  constexpr std::uint64_t kSeed = 1317791056;
  desk::ExplainOptions options;
  options.replays = 0;
  options.most_effects = 0;
  options.link_share = 0.05;
  const bench::ArmOutcome outcome = bench::run_arm_case({ArmHides::kEffects, kSeed}, options);
  ASSERT_NO_FATAL_FAILURE(expect_no_push(outcome));
}

// GIVEN drag that no file knows of, and half a second in which its joint is faster than ever before
// WHEN the recordings are explained THEN the drag is found, and the half second is no push.
TEST(ArmBench, TakesDragAtTheHighestSpeedForNoPush) {
#ifdef OFFNOMINAL_SANITIZE
  GTEST_SKIP() << "minutes under the sanitizers; the analysis has tests of its own";
#endif
  constexpr std::uint64_t kSeed = 1572603511;
  desk::ExplainOptions options;
  options.replays = 0;
  options.link_share = 0.3;
  const bench::ArmOutcome outcome = bench::run_arm_case({ArmHides::kEffects, kSeed}, options);
  ASSERT_NO_FATAL_FAILURE(expect_no_push(outcome));
  ASSERT_TRUE(std::any_of(outcome.score.asked.begin(), outcome.score.asked.end(),
                          [](const auto& one) {
                            return one.what.kind == EffectKind::kQuadraticFriction &&
                                   one.class_size > 0;
                          }))
      << "the drag is there, and in what was found or not told apart";
}

}  // namespace
}  // namespace offnominal::test
