#include "replay/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <offnominal/model/inverse_dynamics.hpp>

#include "common/error.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "desk/sil/serial_robot.hpp"
#include "robot/chain_of.hpp"

// The on-board monitor over a recording of a simulated arm that is healthy, or not from some time
// on.

namespace {

using Eigen::Vector2d;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::record_arm;
using namespace offnominal::desk;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kFaultTime = 6;
constexpr double kBound = 2;  // rad/s^2

RobotDescription watched_arm() {
  RobotDescription robot = arm_description();
  robot.bound = BoundSettings{};
  robot.bound->constant.value = kBound;
  return robot;
}

// From kFaultTime on, joint 2 needs a torque that accelerates it by `acceleration` in the model.
Log faulty_recording(double acceleration) {
  return record_arm({.duration_s = 10}, [acceleration](const ArmInstant& at) -> Vector2d {
    if (at.t_s < kFaultTime) return Vector2d::Zero();
    return offnominal::sim::mass_matrix({}, at.q) * Vector2d(0, acceleration);
  });
}

TEST(Replay, GivenAHealthyRecordingThenThereIsNoAlarmAndNothingIsLearnt) {
  const Replay healthy = replay(watched_arm(), record_arm({.duration_s = 10}));
  EXPECT_EQ(healthy.samples(), 10001);
  EXPECT_FALSE(healthy.detection_time_s);
  EXPECT_TRUE(healthy.alarms.empty());
  EXPECT_TRUE(healthy.refused.empty());
  EXPECT_TRUE(healthy.psi_hat.isZero(0));
  EXPECT_LT(healthy.max_error_to_threshold, 0.01);
  EXPECT_THAT(words_of(healthy), HasSubstr("Nominal"));
}

TEST(Replay, GivenLessThanAResidualTakesToBuildUpThenItIsNotCalledNominal) {
  std::vector<double> shares;
  const Replay part = replay(watched_arm(), record_arm({.duration_s = 0.2}),
                             [&](double share) { shares.push_back(share); });
  EXPECT_TRUE(part.is_too_short());
  EXPECT_THAT(words_of(part), HasSubstr("Too short to judge"));
  EXPECT_EQ(to_json(part)["too_short"], true);
  EXPECT_THAT(shares, ElementsAre(0));
  EXPECT_FALSE(replay(watched_arm(), record_arm({.duration_s = 0.4})).is_too_short());
}

// A constant disturbance d from T on: |e| = d (1 - exp(-alpha s)) / alpha passes mu = K / alpha at
// s = ln(d / (d - K)) / alpha.
TEST(Replay, GivenAHiddenTorqueThenTheAlarmComesWhenTheFilterSaysSo) {
  const double acceleration = 3 * kBound;
  const Replay faulty = replay(watched_arm(), faulty_recording(acceleration));
  ASSERT_TRUE(faulty.detection_time_s);
  const double delay = std::log(acceleration / (acceleration - kBound)) / 10;
  EXPECT_NEAR(*faulty.detection_time_s, kFaultTime + delay, 0.0021);
  ASSERT_FALSE(faulty.alarms.empty());
  EXPECT_EQ(faulty.alarms.front().start_s, *faulty.detection_time_s);
  EXPECT_GT(faulty.alarms.front().max_error_to_threshold, 1);
  const auto before = std::lower_bound(faulty.t_s.begin(), faulty.t_s.end(), kFaultTime);
  EXPECT_TRUE(faulty.psi_hat.topRows(before - faulty.t_s.begin()).isZero(0));
  EXPECT_GT(faulty.psi_hat.cwiseAbs().maxCoeff(), 1);
  EXPECT_THAT(words_of(faulty), HasSubstr("Off nominal"));
}

TEST(Replay, GivenAHiddenTorqueWithinTheBoundThenThereIsNoAlarm) {
  const Replay tolerated = replay(watched_arm(), faulty_recording(0.9 * kBound));
  EXPECT_FALSE(tolerated.detection_time_s);
  EXPECT_NEAR(tolerated.max_error_to_threshold, 0.9, 0.01);
}

constexpr double kTorqueBound = 1;  // N m

RobotDescription arm_in_torque_space() {
  RobotDescription robot = arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.bound.emplace().kind = BoundSettings::Kind::kPerJoint;
  robot.bound->joints.assign(2, {});
  robot.bound->joints[1].value = {kTorqueBound};
  return robot;
}

Log recording_with(const Vector2d& torque) {
  return record_arm({.duration_s = 10}, [torque](const ArmInstant& at) -> Vector2d {
    return at.t_s < kFaultTime ? Vector2d(Vector2d::Zero()) : torque;
  });
}

// A torque d on one joint alone: its residual is d (1 - exp(-alpha s)), in N m, against the bound.
TEST(Replay, GivenTorqueSpaceThenTheFaultyJointIsNamedWhenTheFilterSaysSo) {
  const Replay faulty = replay(arm_in_torque_space(), recording_with({0, 3 * kTorqueBound}));
  ASSERT_TRUE(faulty.detection_time_s);
  EXPECT_NEAR(*faulty.detection_time_s, kFaultTime + std::log(1.5) / 10, 0.0021);
  EXPECT_EQ(faulty.first_joint, 1);
  EXPECT_EQ(faulty.unit, "N m");
  ASSERT_EQ(faulty.joints.size(), 2U);
  EXPECT_FALSE(faulty.joints[0].detection_time_s);
  EXPECT_LT(faulty.joints[0].max_residual, 0.01);
  EXPECT_EQ(faulty.joints[1].detection_time_s, faulty.detection_time_s);
  EXPECT_NEAR(faulty.joints[1].max_threshold, kTorqueBound, 1e-6);
  EXPECT_TRUE(faulty.psi_hat.col(0).isZero(0));
  EXPECT_GT(std::abs(faulty.psi_hat.col(1).mean()), 0.1);
  EXPECT_THAT(words_of(faulty), HasSubstr("joint 2 (" + faulty.joint_names[1] + ") first"));
  const nlohmann::json json = to_json(faulty);
  EXPECT_EQ(json["space"], "torque");
  EXPECT_EQ(json["first_joint"], 2);
  EXPECT_EQ(json["joints"][0]["detection_time_s"], nullptr);
  EXPECT_EQ(json["joints"][1]["alarms"].size(), faulty.joints[1].alarms.size());
  EXPECT_EQ(json["joints"][1]["max_abs_psi_hat"], faulty.psi_hat.col(1).cwiseAbs().maxCoeff());
  for (const char* of_any_joint : {"max_error", "max_threshold", "max_abs_psi_hat"}) {
    ASSERT_TRUE(json.contains(of_any_joint));
    EXPECT_TRUE(json[of_any_joint].is_null()) << of_any_joint << " of which joint?";
  }
  EXPECT_EQ(to_json(replay(watched_arm(), recording_with({0, 1}))).count("joints"), 0U);
}

// A torque d for 20 ms: behind the pole alpha its residual comes to d (1 - exp(-0.02 alpha)).
Log recording_with_a_push(double torque) {
  return record_arm({.duration_s = 8}, [torque](const ArmInstant& at) -> Vector2d {
    return {0, at.t_s >= kFaultTime && at.t_s < kFaultTime + 0.02 ? torque : 0};
  });
}

RobotDescription arm_with_two_filters() {
  RobotDescription robot = arm_in_torque_space();
  robot.estimator.fast_alpha = 100;
  robot.bound->fast = robot.bound->joints;
  return robot;
}

TEST(Replay, GivenASecondFilterThenAPushThatTheFirstOneMissesIsSeen) {
  const Log pushed = recording_with_a_push(4);
  EXPECT_FALSE(replay(arm_in_torque_space(), pushed).detection_time_s) << "0.7 of its threshold";
  const Replay seen = replay(arm_with_two_filters(), pushed);
  ASSERT_TRUE(seen.detection_time_s);
  EXPECT_NEAR(*seen.detection_time_s, kFaultTime, 0.02);
  EXPECT_EQ(seen.first_joint, 1);
  EXPECT_LT(seen.joints[1].max_residual, kTorqueBound);
  EXPECT_GT(seen.joints[1].fast_max_residual, 2);
  EXPECT_GT(seen.max_error_to_threshold, 2);
  const nlohmann::json json = to_json(seen);
  EXPECT_EQ(json["joints"][1]["fast_max_residual"], seen.joints[1].fast_max_residual);
  EXPECT_THAT(report::to_json(page_of(seen, "")).dump(),
              HasSubstr("The same behind the fast filter"));
  EXPECT_EQ(to_json(replay(arm_in_torque_space(), pushed))["joints"][1].count("fast_max_residual"),
            0U);
}

TEST(Replay, GivenTwoLevelsThenItSaysWhenTheSecondWasReached) {
  RobotDescription robot = arm_in_torque_space();
  EXPECT_FALSE(replay(robot, recording_with({0, 3})).has_two_levels);
  robot.bound->joints[1].act_ratio = 2;
  const Replay acts = replay(robot, recording_with({0, 3 * kTorqueBound}));
  ASSERT_TRUE(acts.act_time_s);
  EXPECT_NEAR(*acts.act_time_s, kFaultTime + std::log(3.0) / 10, 0.01);
  EXPECT_LT(*acts.detection_time_s, *acts.act_time_s);
  EXPECT_THAT(words_of(acts),
              testing::ContainsRegex("Beyond the level to act at .* s, joint 2 .*elbow.*\\."));
  EXPECT_EQ(to_json(acts)["act_time_s"], *acts.act_time_s);
  EXPECT_EQ(acts.joints[1].act_time_s, acts.act_time_s);
  EXPECT_FALSE(acts.joints[0].act_time_s.has_value());
  EXPECT_EQ(to_json(acts)["joints"][1]["act_time_s"], *acts.act_time_s);
  EXPECT_TRUE(to_json(acts)["joints"][0]["act_time_s"].is_null());
  // Of the joint that has the level, the line twice as high as its threshold's.
  const auto page = report::to_json(page_of(acts, ""));
  int lines = 0;
  for (const auto& block : page.at("sections").at(0).at("blocks")) {
    if (block.at("type") != "chart") continue;
    for (const auto& series : block.at("series")) {
      if (series.at("name") != "level to act") continue;
      ++lines;
      EXPECT_THAT(block.at("title").get<std::string>(), HasSubstr("elbow"));
      EXPECT_EQ(series.at("y").back(), 2 * block.at("series").at(1).at("y").back().get<double>());
    }
  }
  EXPECT_EQ(lines, 1);
  const Replay noticed = replay(robot, recording_with({0, 1.5 * kTorqueBound}));
  EXPECT_TRUE(noticed.detection_time_s);
  EXPECT_FALSE(noticed.act_time_s);
  EXPECT_THAT(words_of(noticed), HasSubstr("Never beyond the level to act."));
}

// Friction of the elbow, from a time on.
TEST(Replay, GivenTorqueSpaceThenWhichFaultItIsIsSaidWithJointAndSize) {
  const Log log =
      record_arm({.duration_s = 12, .torque_noise = 0.01}, [](const ArmInstant& at) -> Vector2d {
        const double more = at.t_s < kFaultTime ? 0 : 3 * kTorqueBound;
        return {0, more * std::tanh(at.dq[1] / 0.005)};
      });
  const Replay faulty = replay(arm_in_torque_space(), log);
  ASSERT_EQ(faulty.faults.size(), 1U);
  const IsolatedFault& fault = faulty.faults.front();
  EXPECT_STREQ(name_of(fault.kind), "friction");
  EXPECT_EQ(fault.joint, 1);
  EXPECT_NEAR(fault.size, 3 * kTorqueBound, 0.15);
  EXPECT_EQ(fault.unit, "N m");
  EXPECT_TRUE(fault.decided);
  EXPECT_EQ(fault.detection_time_s, *faulty.detection_time_s);
  EXPECT_GT(fault.time_s, fault.detection_time_s);
  EXPECT_LE(fault.time_s, fault.detection_time_s + 2.1);
  EXPECT_THAT(words_of(faulty),
              HasSubstr("Joint 2 (" + faulty.joint_names[1] + "): friction up by "));
  const nlohmann::json json = to_json(faulty);
  EXPECT_EQ(json["faults"][0]["kind"], "friction");
  EXPECT_EQ(json["faults"][0]["joint"], 2);
  EXPECT_EQ(json["faults"][0]["size"], fault.size);
  EXPECT_THAT(report::to_json(page_of(faulty, "")).dump(), HasSubstr("Which fault it is"));
  EXPECT_TRUE(
      to_json(replay(arm_in_torque_space(), record_arm({.duration_s = 10})))["faults"].empty());
}

// Friction of the elbow until `friction_ends_s`, and from `torque_begins_s` on a constant torque on
// the shoulder too.
Log recording_of_two_faults(double friction_ends_s, double torque_begins_s) {
  return record_arm(
      {.duration_s = 26, .torque_noise = 0.01}, [=](const ArmInstant& at) -> Vector2d {
        const bool rubs = at.t_s >= kFaultTime && at.t_s < friction_ends_s;
        const double friction = rubs ? 3 * kTorqueBound * std::tanh(at.dq[1] / 0.005) : 0;
        return {at.t_s < torque_begins_s ? 0 : 3 * kTorqueBound, friction};
      });
}

RobotDescription arm_of_equal_bounds() {
  RobotDescription robot = arm_in_torque_space();
  robot.bound->joints[0].value = {kTorqueBound};
  return robot;
}

TEST(Replay, GivenTorqueSpaceThenAFaultThatIsOverHidesNoOther) {
  const RobotDescription robot = arm_of_equal_bounds();
  constexpr double kEnd = kFaultTime + 4;
  const Replay faulty = replay(robot, recording_of_two_faults(kEnd, 20));
  ASSERT_EQ(faulty.faults.size(), 2U);
  EXPECT_STREQ(name_of(faulty.faults[0].kind), "friction");
  EXPECT_EQ(faulty.faults[0].joint, 1);
  EXPECT_EQ(faulty.faults[1].joint, 0);
  EXPECT_NEAR(faulty.faults[1].detection_time_s, 20, 0.1);
  EXPECT_EQ(*faulty.detection_time_s, faulty.faults[0].detection_time_s) << "the first";
  EXPECT_EQ(replay(robot, recording_of_two_faults(kEnd, 100)).faults.size(), 1U);
}

// The first goes on when the second begins: that is told from its own detection on.
TEST(Replay, GivenTorqueSpaceThenALastingFaultHidesNoOtherJoints) {
  const RobotDescription robot = arm_of_equal_bounds();
  const Replay both = replay(robot, recording_of_two_faults(100, 18));
  ASSERT_GE(both.faults.size(), 2U);
  EXPECT_EQ(both.faults[0].joint, 1);
  EXPECT_NEAR(both.faults[1].detection_time_s, 18, 0.1);
  const Replay one = replay(robot, recording_of_two_faults(100, 100));
  ASSERT_EQ(one.faults.size(), 1U) << "however often it is detected";
  EXPECT_STREQ(name_of(one.faults[0].kind), "friction");
}

TEST(Replay, GivenTorqueSpaceAndFaultsOnTwoJointsThenTheLaterOneIsSaidWithItsDelay) {
  RobotDescription robot = arm_in_torque_space();
  robot.bound->joints[0].value = {2.5};
  const Replay faulty = replay(robot, recording_with({3, 3}));
  EXPECT_EQ(faulty.first_joint, 1);
  ASSERT_TRUE(faulty.joints[0].detection_time_s);
  const double later = *faulty.joints[0].detection_time_s - *faulty.detection_time_s;
  EXPECT_NEAR(later, (std::log(6.0) - std::log(1.5)) / 10, 0.003);
  EXPECT_THAT(words_of(faulty), HasSubstr("; then joint 1 ("));
  // Whose an alarm of any joint is.
  EXPECT_THAT(faulty.alarms.front().joints, ElementsAre(1, 0));
  EXPECT_EQ(joints_of(faulty, faulty.alarms.front()), "joint 2 (elbow), joint 1 (shoulder)");
  EXPECT_EQ(to_json(faulty)["alarms"][0]["joints"], (std::vector{2, 1}));
  EXPECT_THAT(report::to_json(page_of(faulty, "")).dump(),
              HasSubstr("joint 2 (elbow), joint 1 (shoulder)"));
  const report::Page page = page_of(faulty, "");
  EXPECT_EQ(page.verdict.level, report::Level::kBad);
  ASSERT_EQ(page.sections[1].blocks.size(), 2U);
  for (const std::size_t joint : {0U, 1U}) {
    const auto& chart = std::get<report::Chart>(page.sections[1].blocks[joint]);
    ASSERT_EQ(chart.events.size(), 1U);
    EXPECT_EQ(chart.events[0].x, *faulty.joints[joint].detection_time_s)
        << "its own, not the first";
  }
  const Replay healthy = replay(robot, recording_with({0, 0.9}));
  EXPECT_FALSE(healthy.detection_time_s || healthy.first_joint);
  EXPECT_NEAR(healthy.max_error_to_threshold, 0.9, 0.01);
  EXPECT_THAT(words_of(healthy), HasSubstr("Nominal"));
}

TEST(Replay, GivenTwoJointsThatCrossInOneTickThenItSaysSo) {
  const Replay faulty = replay(arm_in_torque_space(), recording_with({50, 50}));
  ASSERT_EQ(faulty.joints[0].detection_time_s, faulty.joints[1].detection_time_s);
  EXPECT_THAT(words_of(faulty), HasSubstr(" in the same tick."));
  EXPECT_THAT(words_of(faulty), Not(HasSubstr("0.000 s after it")));
}

TEST(Replay, GivenOneThresholdOfAllThenItsAlarmsNameNoJoint) {
  const Replay faulty = replay(watched_arm(), faulty_recording(3 * kBound));
  EXPECT_TRUE(faulty.alarms.front().joints.empty());
  EXPECT_FALSE(to_json(faulty)["alarms"][0].contains("joints"));
}

std::string refusal(const RobotDescription& robot, const Log& log) {
  try {
    static_cast<void>(replay(robot, log));
  } catch (const InputError& error) {
    return error.what();
  }
  return "replayed";
}

TEST(Replay, RefusesWhatItCannotReplay) {
  const Log log = record_arm({.duration_s = 0.1});
  RobotDescription robot = watched_arm();
  robot.joints.pop_back();
  EXPECT_THAT(refusal(robot, log), HasSubstr("found 2 joints; allowed: 1, as robot arm has"));
  Log of_one = log;
  of_one.q.conservativeResize(Eigen::NoChange, 1);
  EXPECT_THAT(refusal(arm_description(), of_one), HasSubstr("found 1 joint; allowed: 2"));
  EXPECT_THAT(refusal(arm_description(), log), HasSubstr("uncertainty_bound"));
  robot = watched_arm();
  robot.estimator.alpha = 2000;
  EXPECT_THAT(refusal(robot, log), HasSubstr("alpha_per_s * period = 2"));
  robot = watched_arm();
  robot.estimator.hidden_units = kMaxHiddenUnits + 1;
  EXPECT_THAT(refusal(robot, log), HasSubstr("estimator.hidden_units"));
  robot = watched_arm();
  robot.joints[1].joint.max_position = -5;
  robot.joints[1].joint.min_position = -6;
  EXPECT_THAT(refusal(robot, log), HasSubstr("all 101 samples"));
}

TEST(Replay, GivenSamplesThatAreRefusedThenTheyAreCountedByTheirStatus) {
  Log log = record_arm({.duration_s = 1});
  log.tau(500, 1) = std::numeric_limits<double>::quiet_NaN();
  log.tau(501, 1) = std::numeric_limits<double>::quiet_NaN();
  const Replay result = replay(watched_arm(), log);
  ASSERT_EQ(result.refused.size(), 1U);
  const auto& [status, refusals] = *result.refused.begin();
  EXPECT_EQ(status, "NonFiniteTorque");
  EXPECT_EQ(refusals.count, 2);
  EXPECT_NEAR(refusals.first_s, 0.5, 1e-9);
  EXPECT_EQ(result.t_s.size(), 999);
  EXPECT_EQ(result.samples(), 1001);
  EXPECT_EQ(result.judged(), 999);
  EXPECT_FALSE(result.is_blind());
  EXPECT_THAT(words_of(result), HasSubstr("Nominal"));
}

// GIVEN samples that nobody judged WHEN they are many THEN "no alarm" is no good news.
TEST(Replay, GivenManySamplesThatAreRefusedThenItIsBlind) {
  for (const int step : {1, 50}) {  // three in a row; one in fifty
    Log log = record_arm({.duration_s = 1});
    for (Eigen::Index row = 500; row < (step == 1 ? 503 : 1000); row += step) {
      log.tau(row, 1) = std::numeric_limits<double>::quiet_NaN();
    }
    Replay result = replay(watched_arm(), log);
    EXPECT_EQ(result.is_blind(), step == 1) << "10 of 1001 are one in a hundred";
    log.tau(120, 0) = log.tau(125, 0) = std::numeric_limits<double>::quiet_NaN();
    result = replay(watched_arm(), log);
    EXPECT_TRUE(result.is_blind());
    EXPECT_THAT(words_of(result), HasSubstr("Blind: "));
    EXPECT_EQ(to_json(result)["blind"], true);
    EXPECT_EQ(page_of(result, "").verdict.level, report::Level::kWarn);
  }
}

// An arm that stands still, held by what its model says; from half of the recording on by more than
// that on its last joint.
Log held_arm(const RobotDescription& robot) {
  const auto model = make_model(chain_of<offnominal::kRuntimeJoints, double>(robot));
  const Eigen::Index joints = robot.joint_count();
  const offnominal::Vector<offnominal::kRuntimeJoints, double> zero =
      offnominal::Vector<offnominal::kRuntimeJoints, double>::Zero(joints);
  constexpr Eigen::Index kSamples = 1001;
  Log log;
  log.file = "held.csv";
  log.period_s = 0.001;
  log.t_s = Eigen::VectorXd::LinSpaced(kSamples, 0, 1);
  log.q = Eigen::MatrixXd::Zero(kSamples, joints);
  log.dq = log.q;
  log.tau = inverse_dynamics(model, zero, zero, zero, 0.0).transpose().replicate(kSamples, 1);
  log.tau.col(joints - 1).tail(kSamples / 2).array() += 2.0;
  return log;
}

TEST(Replay, TakesEveryNumberOfJoints) {
  for (const int joints : {1, 5, offnominal::kMaxJoints}) {
    const RobotDescription robot = offnominal::test::serial_robot(joints);
    const Replay result = replay(robot, held_arm(robot));
    ASSERT_EQ(result.psi_hat.cols(), joints);
    EXPECT_EQ(result.judged(), 1001) << joints;
    ASSERT_TRUE(result.detection_time_s) << joints;
    EXPECT_GT(*result.detection_time_s, 0.5) << joints;
    EXPECT_LT(*result.detection_time_s, 0.7) << joints;
    Eigen::Index worst = -1;
    result.error.row(result.error.rows() - 1).cwiseAbs().maxCoeff(&worst);
    EXPECT_EQ(worst, joints - 1);
  }
}

TEST(Replay, TheJsonSaysWhatTheReplayDoes) {
  const Replay faulty = replay(watched_arm(), faulty_recording(3 * kBound));
  const nlohmann::json json = to_json(faulty);
  EXPECT_EQ(json.at("robot"), "arm");
  EXPECT_EQ(json.at("unit"), "rad/s");
  EXPECT_EQ(json.at("scalar"), "double");
  EXPECT_EQ(json.at("samples"), 10001);
  EXPECT_EQ(json.at("detection_time_s"), *faulty.detection_time_s);
  ASSERT_EQ(json.at("alarms").size(), faulty.alarms.size());
  EXPECT_EQ(json.at("alarms").at(0).at("start_s"), faulty.alarms[0].start_s);
  EXPECT_EQ(json.at("max_error_to_threshold"), faulty.max_error_to_threshold);
  EXPECT_EQ(json.at("max_abs_psi_hat"), faulty.psi_hat.cwiseAbs().maxCoeff());
  for (const char* key : {"log", "period_s", "hidden_units", "seed", "refused", "max_error",
                          "max_threshold", "max_weight_norm"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  const nlohmann::json healthy = to_json(replay(watched_arm(), record_arm({.duration_s = 1})));
  EXPECT_TRUE(healthy.at("detection_time_s").is_null());
  EXPECT_TRUE(healthy.at("alarms").empty());
}

}  // namespace
