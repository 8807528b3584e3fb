#include "calibrate/calibrate_joints.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "calibrate/calibrate_one.hpp"
#include "calibrate/joints_report.hpp"
#include "calibrate/recorded_error.hpp"
#include "common/error.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"

// Bounds joint by joint, of an arm with friction that its model does not know.

namespace offnominal::desk {
namespace {

using Eigen::Vector2d;
using test::ArmInstant;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RobotDescription arm_watched_by_joint() {
  RobotDescription robot = test::arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  return robot;
}

Vector2d unknown_friction(const ArmInstant& at) {
  return {2.0 * at.dq[0], 0.15 * std::tanh(at.dq[1] / 0.05)};
}

Log arm_run(std::uint64_t seed, const test::HiddenTorque& hidden = unknown_friction) {
  Log log = test::record_arm({.duration_s = 30, .rate_hz = 200, .torque_noise = 0.05, .seed = seed},
                             hidden);
  log.file = "run " + std::to_string(seed);
  return log;
}

const JointsCalibration& calibrated() {
  static const JointsCalibration result =
      calibrate_joints(arm_watched_by_joint(), {}, {arm_run(1), arm_run(2)}, {arm_run(3)});
  return result;
}

TEST(CalibrateJoints, FindsABoundOfEachJointThatHoldsAndIsFelt) {
  const JointsCalibration& result = calibrated();
  EXPECT_THAT(result.objections, IsEmpty());
  ASSERT_EQ(result.joints.size(), 2U);
  for (const JointCalibration& joint : result.joints) {
    EXPECT_EQ(joint.calibration.unit, "N m");
    EXPECT_EQ(joint.calibration.level.held_out_alarms, 0);
    EXPECT_DOUBLE_EQ(joint.calibration.level.alarms_per_hour, 0.05) << "half of 0.1 each";
    const BoundMargin margin = margin_of(joint.calibration);
    EXPECT_GT(margin.largest_ratio_after, 0.3);
    EXPECT_LE(margin.largest_ratio_after, 1);
  }
  // Viscous friction asks for a table over the joint's speed; dry friction of 0.15 N m for a
  // constant that is neither below it nor far above.
  const auto& bounds = result.robot.bound->joints;
  ASSERT_GT(bounds[0].at.size(), 2U);
  EXPECT_GT(bounds[0].value.back(), 2 * bounds[0].value.front());
  EXPECT_GT(margin_of(result.joints[1].calibration).mean_after, 0.1);
  EXPECT_LT(margin_of(result.joints[1].calibration).mean_after, 0.4);
}

TEST(CalibrateJoints, WhatTheWrittenFileSaysIsWhatTheReplayShows) {
  const JointsCalibration& result = calibrated();
  const RobotDescription again = parse_robot(robot_text(result.robot), "r.toml");
  EXPECT_EQ(robot_text(again), robot_text(result.robot));
  const Replay shown = replay(again, arm_run(3));
  EXPECT_FALSE(shown.detection_time_s);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto& stretches = result.joints[static_cast<std::size_t>(i)].calibration.stretches;
    EXPECT_EQ(shown.thresholds.col(i), stretches.back().threshold_after);
    EXPECT_EQ(shown.error.col(i).cwiseAbs(), stretches.back().error_norm);
  }
}

// An arm with that torque on one joint from begin_s on; a recording that had no part in the
// figures.
Replay run_with(const RobotDescription& robot, Eigen::Index joint, double torque, double begin_s) {
  return replay(robot, arm_run(4, [&](const ArmInstant& at) -> Vector2d {
                  Vector2d fault = Vector2d::Zero();
                  if (at.t_s >= begin_s) fault[joint] = torque;
                  return unknown_friction(at) + fault;
                }));
}

TEST(CalibrateJoints, TheSmallestFaultsAreSeenWhereTheySay) {
  const JointsCalibration& result = calibrated();
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    const SmallestFault& fault = result.joints[static_cast<std::size_t>(joint)].fault;
    EXPECT_LT(fault.usual, fault.certain);
    EXPECT_LT(fault.twice_s, fault.window_s);
    constexpr int kBeginnings = 10;
    int seen = 0;
    int seen_a_tenth = 0;
    for (int i = 0; i < kBeginnings; ++i) {
      const double begin_s = 3 + 2.3 * i;
      const double sign = i % 2 == 0 ? 1 : -1;
      const auto is_seen = [&](double torque) {
        const Replay run = run_with(result.robot, joint, sign * torque, begin_s);
        return run.first_joint == static_cast<int>(joint) &&
               *run.detection_time_s <= begin_s + fault.window_s;
      };
      seen += is_seen(fault.usual) ? 1 : 0;
      seen_a_tenth += is_seen(0.1 * fault.usual) ? 1 : 0;
      const Replay certain = run_with(result.robot, joint, sign * fault.certain_with, begin_s);
      ASSERT_TRUE(certain.detection_time_s);
      EXPECT_GE(*certain.detection_time_s, begin_s);
      EXPECT_LE(*certain.detection_time_s, begin_s + fault.certain_s + 0.006);
      EXPECT_EQ(certain.first_joint, static_cast<int>(joint));
    }
    EXPECT_GE(seen, 8) << "95 of 100 of joint " << joint + 1;
    EXPECT_LT(seen_a_tenth, seen) << "the figure is far too large for joint " << joint + 1;
  }
}

TEST(CalibrateJoints, CertainIsAboveTwiceWhatTheBoundCanComeToAtAnySpeed) {
  const JointsCalibration& result = calibrated();
  for (std::size_t i = 0; i < 2; ++i) {
    const JointBoundSettings& bound = result.robot.bound->joints[i];
    const double alpha = result.robot.estimator.alpha;
    const double fastest = *std::max_element(bound.value.begin(), bound.value.end()) +
                           2 * alpha * bound.momentum_error;
    EXPECT_DOUBLE_EQ(result.joints[i].fault.certain, 2 * fastest);
  }
}

TEST(CalibrateJoints, TellsThemInWordsAndInNumbers) {
  const CalibrateNames names{"arm.toml", "new.toml", "offnominal calibrate"};
  const auto json = to_json(calibrated(), names);
  EXPECT_EQ(json["space"], "torque");
  EXPECT_EQ(json["joints"][1]["joint"], 2);
  EXPECT_EQ(json["joints"][1]["smallest_fault"]["unit"], "N m");
  EXPECT_EQ(json["joints"][0]["bound"]["unit"], "N m");
  EXPECT_EQ(json["joints"][0]["bound"]["at_unit"], "rad/s");
  EXPECT_GT(json["joints"][0]["smallest_fault"]["seen_in_95_of_100"], 0);
  EXPECT_THAT(text_of(calibrated(), names), HasSubstr("0.1 per hour of all joints"));
  EXPECT_THAT(verdict_of(calibrated()), HasSubstr("N m on joint 2; 0 alarms of 2 joints"));
  EXPECT_EQ(page_of(calibrated(), names).sections.size(), 2U);
}

std::string page_text(const JointsCalibration& calibration) {
  return report::to_json(page_of(calibration, {"arm.toml", "new.toml", ""})).dump();
}

TEST(CalibrateJoints, ShowsHowEachStandsToTheOldOneAndWhatTheCountExcludes) {
  const CalibrateNames names{"arm.toml", "new.toml", "offnominal calibrate"};
  EXPECT_THAT(text_of(calibrated(), names), ContainsRegex("1 shoulder +none +359\n"))
      << "3 / 30 s by the hour, and there was no bound";
  JointsCalibration result = calibrated();
  for (JointCalibration& joint : result.joints) {
    joint.calibration.old_bound.emplace();
    for (JudgedStretch& stretch : joint.calibration.stretches) {
      stretch.mean_threshold_before = 4 * stretch.mean_threshold_after;
    }
  }
  EXPECT_THAT(text_of(result, names), ContainsRegex("1 shoulder +0\\.250 +359\n"));
  EXPECT_THAT(page_text(result), HasSubstr("mean threshold to the old one's"));
  EXPECT_THAT(page_text(result), HasSubstr("excluded from"));
}

TEST(CalibrateJoints, WritesLargeFiguresOut) {
  JointsCalibration result = calibrated();
  result.joints[0].fault.usual = 281.4;
  EXPECT_THAT(verdict_of(result), HasSubstr("seen from 280 N m on joint 1"));
  result.joints.resize(1);
  EXPECT_THAT(verdict_of(result), HasSubstr("0 alarms of 1 joint in 30 s"));
}

TEST(CalibrateJoints, ObjectsToAFaultInOneRecordingAndSaysOnWhichJoint) {
  const Log faulty = arm_run(5, [](const ArmInstant& at) -> Vector2d {
    const Vector2d push(0, at.t_s > 15 && at.t_s < 15.5 ? 20 : 0);
    return unknown_friction(at) + push;
  });
  const JointsCalibration result =
      calibrate_joints(arm_watched_by_joint(), {}, {arm_run(1), faulty}, {arm_run(3)});
  ASSERT_FALSE(result.objections.empty());
  EXPECT_THAT(result.objections.front(), HasSubstr("joint 2 ("));
  EXPECT_THAT(result.objections.front(), HasSubstr(" the residual is "));
  for (const auto* remarks : {&result.objections, &result.notes}) {
    for (const std::string& words : *remarks) {
      EXPECT_THAT(words, Not(HasSubstr("|e|"))) << "that is of all joints, and no torque";
    }
  }
  EXPECT_THAT(verdict_of(result), HasSubstr("no bounds that can be trusted"));
}

TEST(CalibrateJoints, SaysOfAJointWithoutResidualThatItWasNotMoved) {
  std::vector<RecordedError> recordings = {
      joint_errors(arm_watched_by_joint(), arm_run(1)).slow[1]};
  recordings[0].error_norm.setZero();
  try {
    static_cast<void>(data_of(std::move(recordings), 1, 1, 2));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("joint 2: found no residual at all: it did not move"));
    EXPECT_THAT(error.what(), HasSubstr("or take it out of the robot"));
  }
}

TEST(CalibrateJoints, OfOneRecordingShareItsSignals) {
  const auto joints = joint_errors(arm_watched_by_joint(), arm_run(1)).slow;
  ASSERT_EQ(joints.size(), 2U);
  EXPECT_EQ(joints[0].signals, joints[1].signals);
  EXPECT_EQ(joints[0].signals->dq, arm_run(1).dq);
}

// With a faster filter beside the estimator's, and a second level of both.
const JointsCalibration& calibrated_twice() {
  static const JointsCalibration kResult = [] {
    RobotDescription robot = arm_watched_by_joint();
    robot.estimator.fast_alpha = 5 * robot.estimator.alpha;
    CalibrateRequest request;
    request.act_alarms_per_hour = 0.001;
    return calibrate_joints(robot, request, {arm_run(1), arm_run(2)}, {arm_run(3)});
  }();
  return kResult;
}

TEST(CalibrateJoints, GivenASecondFilterThenItFindsBoundsBehindItToo) {
  const JointsCalibration& result = calibrated_twice();
  EXPECT_TRUE(result.objections.empty());
  ASSERT_EQ(result.fast.size(), 2U);
  const BoundSettings& bound = *result.robot.bound;
  ASSERT_EQ(bound.fast.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(margin_of(result.fast[i].calibration).mean_after,
              margin_of(result.joints[i].calibration).mean_after)
        << "more comes through it";
    EXPECT_LT(result.fast[i].fault.certain_s, result.joints[i].fault.certain_s);
    EXPECT_GE(bound.joints[i].act_ratio, 1);
    EXPECT_GE(bound.fast[i].act_ratio, 1);
  }
  EXPECT_GT(bound.fast[0].act_ratio + bound.fast[1].act_ratio + bound.joints[0].act_ratio +
                bound.joints[1].act_ratio,
            4)
      << "a hundredth of the rate is a higher threshold somewhere";
  EXPECT_EQ(robot_text(parse_robot(robot_text(result.robot), "r.toml")), robot_text(result.robot));
  EXPECT_FALSE(replay(result.robot, arm_run(3)).detection_time_s);
}

TEST(CalibrateJoints, GivenASecondFilterThenItsRowsAndLevelsAreTold) {
  const CalibrateNames names{"arm.toml", "new.toml", "offnominal calibrate"};
  const std::string text = text_of(calibrated_twice(), names);
  EXPECT_THAT(text, HasSubstr("1 shoulder, fast"));
  EXPECT_THAT(text, HasSubstr("all joints and both filters"));
  EXPECT_THAT(text, HasSubstr("act at: the second level, for 0.001 false alarms per hour"));
  const auto json = to_json(calibrated_twice(), names);
  EXPECT_EQ(json["act_alarms_per_hour"], 0.001);
  EXPECT_GE(json["joints"][0]["fast"]["bound"]["act_ratio"], 1);
  EXPECT_GT(json["joints"][1]["fast"]["smallest_fault"]["seen_in_95_of_100"], 0);
  EXPECT_THAT(page_text(calibrated_twice()), HasSubstr("shoulder, fast"));
  EXPECT_THAT(text_of(calibrated(), names), Not(HasSubstr("act at")));
}

// Each filter has blocks of its own length, and both are told where they differ.
TEST(CalibrateJoints, GivenASecondFilterThenItsBlocksAreToldToo) {
  JointsCalibration result;
  result.joints.resize(2);
  result.joints[0].calibration.level.blocks = 60;
  result.joints[0].calibration.level.block_s = 5;
  EXPECT_EQ(blocks_words(result), "60 blocks of 5 s");
  result.fast = result.joints;
  EXPECT_EQ(blocks_words(result), "60 blocks of 5 s");
  result.fast[0].calibration.level.blocks = 300;
  result.fast[0].calibration.level.block_s = 1;
  EXPECT_EQ(blocks_words(result), "60 blocks of 5 s, behind the fast filter 300 blocks of 1 s");
}

TEST(CalibrateJoints, RefusesAVelocityError) {
  CalibrateRequest request;
  request.velocity_error = 0.1;
  try {
    static_cast<void>(calibrate_joints(arm_watched_by_joint(), request, {arm_run(1)}, {}));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("leave --velocity-error out"));
  }
}

}  // namespace
}  // namespace offnominal::desk
