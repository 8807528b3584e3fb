#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "desk/compare/recorded_arm.hpp"
#include "replay/replay.hpp"

// What the monitor does not see: samples that it refuses, one behind the other.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using test::ArmInstant;
using ::testing::HasSubstr;
using ::testing::Not;

// Tight: a velocity that is integrated over a gap as over one tick is far beyond it.
constexpr double kBound = 0.2;  // rad/s^2, or N m

RobotDescription arm_in(EstimatorSpace space) {
  RobotDescription robot = test::arm_description();
  robot.estimator.space = space;
  BoundSettings& bound = robot.bound.emplace();
  bound.constant.value = kBound;
  if (space == EstimatorSpace::kTorque) {
    bound.kind = BoundSettings::Kind::kPerJoint;
    bound.joints.assign(2, {});
    for (JointBoundSettings& joint : bound.joints) joint.value = {kBound};
  }
  return robot;
}

void refuse(Log& log, Index first, Index count) {
  log.tau.col(1).segment(first, count).setConstant(std::numeric_limits<double>::quiet_NaN());
}

class BlindReplay : public testing::TestWithParam<EstimatorSpace> {
 protected:
  RobotDescription robot_ = arm_in(GetParam());
};

TEST_P(BlindReplay, GivenAGapInAHealthyRecordingThenThereIsNoAlarmBehindIt) {
  const Log whole = test::record_arm({.duration_s = 4});
  ASSERT_FALSE(replay(robot_, whole).detection_time_s);
  for (const Index gap : {1, 2, 3, 10, 300}) {
    for (const Index at : {1000, 1700, 2900}) {
      Log log = whole;
      refuse(log, at, gap);
      const Replay result = replay(robot_, log);
      EXPECT_FALSE(result.detection_time_s) << gap << " samples from " << at;
      EXPECT_LT(result.max_error_to_threshold, 0.5) << gap << " samples from " << at;
      EXPECT_EQ(result.samples(), whole.sample_count());
      ASSERT_EQ(result.blind.size(), gap > 2 ? 1U : 0U) << gap;
      if (gap <= 2) continue;
      EXPECT_NEAR(result.blind[0].start_s, 0.001 * static_cast<double>(at), 1e-9);
      EXPECT_NEAR(result.blind[0].end_s, 0.001 * static_cast<double>(at + gap), 1e-9);
      EXPECT_EQ(result.blind[0].samples, gap);
      EXPECT_NEAR(result.blind_s(), 0.001 * static_cast<double>(gap), 1e-9);
    }
  }
}

// An error of 8 Hz is above the bound for an instant and far below it behind the filter. A monitor
// whose threshold begins at nothing where the error is largest would alarm.
TEST_P(BlindReplay, GivenAnErrorThatTheFilterForgivesThenThereIsNoAlarmBehindAGap) {
  const bool in_torque = GetParam() == EstimatorSpace::kTorque;
  const Log whole = test::record_arm({.duration_s = 4}, [&](const ArmInstant& at) -> Vector2d {
    const Vector2d error(0, at.t_s < 1 ? 0 : 3 * kBound * std::cos(50 * at.t_s));
    return in_torque ? error : Vector2d(sim::mass_matrix({}, at.q) * error);
  });
  ASSERT_LT(replay(robot_, whole).max_error_to_threshold, 0.9);
  for (Index at = 2000; at < 2130; at += 13) {
    for (const Index gap : {3, 300}) {
      Log log = whole;
      refuse(log, at, gap);
      EXPECT_FALSE(replay(robot_, log).detection_time_s) << gap << " samples from " << at;
    }
  }
}

TEST_P(BlindReplay, GivenGapsAtBothEndsThenTheyAreBlindAndTheRestIsJudged) {
  Log log = test::record_arm({.duration_s = 2});
  refuse(log, 0, 400);
  refuse(log, 1901, 100);
  const Replay result = replay(robot_, log);
  EXPECT_FALSE(result.detection_time_s);
  ASSERT_EQ(result.blind.size(), 2U);
  EXPECT_EQ(result.blind[0].start_s, 0);
  EXPECT_NEAR(result.blind[0].end_s, 0.4, 1e-9);
  EXPECT_NEAR(result.blind[1].start_s, 1.901, 1e-9);
  EXPECT_EQ(result.blind[1].end_s, log.t_s[log.sample_count() - 1]);
}

TEST_P(BlindReplay, GivenAFaultThatLastsThenItIsFoundAgainBehindTheGap) {
  Log log = test::record_arm({.duration_s = 4}, [](const ArmInstant& at) -> Vector2d {
    return {0, at.t_s > 1 ? 3.0 : 0.0};
  });
  refuse(log, 2000, 200);
  const Replay result = replay(robot_, log);
  ASSERT_TRUE(result.detection_time_s);
  EXPECT_LT(*result.detection_time_s, 1.2);
  ASSERT_GE(result.alarms.size(), 2U) << "a stretch does not go over what nobody saw";
  EXPECT_LT(result.alarms[0].end_s, 2);
  EXPECT_GT(result.alarms.back().start_s, 2.2);
  EXPECT_THAT(words_of(result), HasSubstr("Off nominal"));
  EXPECT_THAT(words_of(result), HasSubstr("Blind for 0.200 s, from 2.000 to 2.200 s"));
  EXPECT_EQ(page_of(result, "").verdict.level, report::Level::kBad);
}

// Its time goes on while nobody sees: begun anew, it would be out of step behind the gap.
TEST_P(BlindReplay, GivenADisturbanceInTimeThenItStaysInStepOverTheGap) {
  RobotDescription robot = robot_;
  robot.effects.push_back(test::effect_of(EffectKind::kPeriodicDisturbance, 1, {2.0, 0.0, 1.7}));
  const auto disturbance = [](const ArmInstant& at) -> Vector2d {
    return {0, 2.0 * std::sin(1.7 * at.t_s)};
  };
  const Log whole = test::record_arm({.duration_s = 4}, disturbance);
  ASSERT_LT(replay(robot, whole).max_error_to_threshold, 0.5);
  for (const Index gap : {2, 700}) {
    for (const Index at : {0, 1700}) {
      Log log = whole;
      refuse(log, at, gap);
      EXPECT_LT(replay(robot, log).max_error_to_threshold, 0.5) << gap << " from " << at;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(InBothSpaces, BlindReplay,
                         testing::Values(EstimatorSpace::kAcceleration, EstimatorSpace::kTorque),
                         [](const auto& one) {
                           return std::string(
                               one.param == EstimatorSpace::kTorque ? "Torque" : "Acceleration");
                         });

TEST(BlindReplayReport, SaysWhereAndHowLongInWordsInNumbersAndOnThePage) {
  Log log = test::record_arm({.duration_s = 4});
  refuse(log, 1000, 50);
  refuse(log, 2000, 25);
  refuse(log, 3000, 1);
  const Replay result = replay(arm_in(EstimatorSpace::kAcceleration), log);
  EXPECT_THAT(words_of(result),
              HasSubstr("Blind for 0.075 s in all, in 2 stretches, the first from 1.000 to 1.050 "
                        "s: what happened there nobody saw, and the monitor began afresh behind "
                        "each."));
  EXPECT_THAT(words_of(result), HasSubstr("76 samples refused (NonFiniteTorque"));
  const nlohmann::json json = to_json(result);
  EXPECT_NEAR(json["blind_s"].get<double>(), 0.075, 1e-9);
  ASSERT_EQ(json["blind_stretches"].size(), 2U);
  EXPECT_NEAR(json["blind_stretches"][1]["start_s"].get<double>(), 2.0, 1e-9);
  EXPECT_NEAR(json["blind_stretches"][1]["end_s"].get<double>(), 2.025, 1e-9);
  EXPECT_EQ(json["blind_stretches"][1]["samples"], 25);
  const std::string page = report::to_json(page_of(result, "")).dump();
  EXPECT_THAT(page, HasSubstr("Blind for 0.075 s: what was here nobody saw"));
  EXPECT_THAT(page, HasSubstr("The lines are broken where the monitor was blind."));
  // Of a whole recording nothing of it is said.
  const Replay whole = replay(arm_in(EstimatorSpace::kAcceleration), test::record_arm({}));
  EXPECT_THAT(words_of(whole), Not(HasSubstr("Blind")));
  EXPECT_TRUE(to_json(whole)["blind_stretches"].empty());
  EXPECT_THAT(report::to_json(page_of(whole, "")).dump(), Not(HasSubstr("lind")));
}

TEST(BlindReplayReport, BreaksTheLinesWhereNothingWasSeen) {
  Log log = test::record_arm({.duration_s = 1});
  refuse(log, 500, 50);
  const report::Page page = page_of(replay(arm_in(EstimatorSpace::kTorque), log), "");
  for (const report::Section& section : page.sections) {
    for (const report::Block& block : section.blocks) {
      const auto* chart = std::get_if<report::Chart>(&block);
      if (chart == nullptr) continue;
      for (const report::Series& series : chart->series) {
        EXPECT_TRUE(std::is_sorted(series.x.begin(), series.x.end()));
        EXPECT_EQ(
            std::count_if(series.y.begin(), series.y.end(), [](double y) { return std::isnan(y); }),
            1)
            << chart->title << ", " << series.name;
      }
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
