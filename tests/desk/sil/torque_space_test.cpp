// Robots whose monitor judges joint by joint, at both ends of a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <optional>
#include <string>
#include <vector>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "paper/two_link_robot.hpp"
#include "sil/sil_report.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEvent;
using sim::FaultEventKind;
using test::by_joint_robot;
using testing::HasSubstr;
using testing::Not;

// Holds for what frames and floats round, and for the start of the motion.
constexpr double kBoundNm = 0.5;

FaultEvent push_on(int joint, double size_nm) {
  return {
      .kind = FaultEventKind::kDisturbanceTorque, .begin_s = 1.0, .joint = joint, .size = size_nm};
}

// The paper's arm, with bounds that hold its friction and its disturbance.
RobotDescription paper_arm_by_joint() {
  RobotDescription robot = paper::two_link_robot();
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.bound = BoundSettings{};
  robot.bound->kind = BoundSettings::Kind::kPerJoint;
  robot.bound->joints = {{.at = {}, .value = {3.0}}, {.at = {}, .value = {3.0}}};
  return robot;
}

class AnyRobotByJoint : public testing::TestWithParam<int> {};

TEST_P(AnyRobotByJoint, IsQuietWhileItIsHealthy) {
  const RobotDescription robot = by_joint_robot(GetParam(), kBoundNm);
  const SilResult result = run(robot, scenario_of(robot));
  EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
  EXPECT_FALSE(result.run.detection_time_s.has_value());
  EXPECT_FALSE(result.run.first_joint.has_value());
  EXPECT_LT(result.run.max_error_to_threshold_before_fault, 0.8);
  EXPECT_EQ(result.run.max_abs_psi_hat_before_fault, 0);
  EXPECT_EQ(to_json(result).at("first_joint"), nullptr);
}

// Whichever joint it is on: that one is named, soon, and no other.
TEST_P(AnyRobotByJoint, NamesTheJointOfAFault) {
  const RobotDescription robot = by_joint_robot(GetParam(), kBoundNm);
  for (int joint = 0; joint < GetParam(); ++joint) {
    for (const FaultEvent& fault :
         {push_on(joint, 3 * kBoundNm), FaultEvent{.kind = FaultEventKind::kFrictionJump,
                                        .begin_s = 1.0,
                                        .joint = joint,
                                        .size = 3 * kBoundNm}}) {
      const SilResult result = run(robot, scenario_of(robot, {fault}));
      ASSERT_TRUE(result.run.first_joint.has_value()) << joint;
      EXPECT_EQ(*result.run.first_joint, joint) << info_of(fault.kind).name;
      ASSERT_TRUE(result.run.detection_time_s.has_value()) << joint;
      EXPECT_GE(*result.run.detection_time_s, 1.0) << joint;
      // Friction shows while the joint moves, and every one turns back once in these two seconds.
      const bool pushed = fault.kind == FaultEventKind::kDisturbanceTorque;
      EXPECT_LT(*result.run.detection_time_s, pushed ? 1.3 : 1.8) << joint;
      for (int other = 0; other < GetParam(); ++other) {
        const auto& found = result.run.joints[static_cast<std::size_t>(other)].detection_time_s;
        EXPECT_EQ(found.has_value(), other == joint) << joint << ", " << other;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, AnyRobotByJoint,
                         testing::ValuesIn(test::every_nth(std::array{1, 4, 7}, 3)));

TEST(TorqueSpace, SaysInWordsAndNumbersWhichJointItWas) {
  const RobotDescription robot = by_joint_robot(4, kBoundNm);
  Scenario scenario = scenario_of(robot, {push_on(2, 3 * kBoundNm)});
  scenario.record = true;
  const SilResult result = run(robot, scenario);
  EXPECT_THAT(sentence_of(result), HasSubstr("First off nominal is joint 3 (joint3)."));
  EXPECT_THAT(text_of(result), testing::ContainsRegex("joints off nominal +joint 3 .joint3. at 1"));
  const auto json = to_json(result);
  EXPECT_EQ(json.at("first_joint"), 3);
  ASSERT_EQ(json.at("joints").size(), 4U);
  EXPECT_EQ(json.at("joints")[2].at("detection_time_s"), json.at("detection_time_s"));
  EXPECT_EQ(json.at("joints")[1].at("detection_time_s"), nullptr);
  const auto& residual = result.run.series.joint_residual;
  ASSERT_EQ(residual.size(), 4U);
  EXPECT_GT(residual[2].back(), 2 * kBoundNm) << "what is beyond the threshold is being learnt";
  EXPECT_LT(residual[1].back(), kBoundNm);
  EXPECT_FALSE(page_of(result, "offnominal sil").sections.empty());
}

// What a fault of the plant is behind the filter: a torque of its joint, as the residual shows it.
TEST(TorqueSpace, JudgesByTheTorqueThatAFaultIs) {
  const RobotDescription robot = by_joint_robot(4, kBoundNm);
  constexpr double kLevel = 4 * kBoundNm;
  Scenario scenario = scenario_of(
      robot, {{.kind = FaultEventKind::kFrictionJump, .begin_s = 1.0, .joint = 1, .size = kLevel}});
  scenario.record = true;
  const SilResult result = run(robot, scenario);
  const auto largest = [&](std::size_t joint) {
    const std::vector<double>& of_joint = result.run.series.joint_fault[joint];
    return *std::max_element(of_joint.begin(), of_joint.end());
  };
  EXPECT_GT(largest(1), 0.9 * kLevel);
  EXPECT_LT(largest(1), 1.01 * kLevel);
  for (const std::size_t other : {0U, 2U, 3U}) EXPECT_LT(largest(other), 1e-6) << other;
  ASSERT_TRUE(result.run.guaranteed_time_s.has_value());
  EXPECT_LE(*result.run.detection_time_s, *result.run.guaranteed_time_s);
}

TEST(TorqueSpace, InAccelerationSpaceNoJointIsNamed) {
  const RobotDescription robot = test::serial_robot(4);
  const SilResult result = run(robot, scenario_of(robot, {push_on(2, 30)}));
  ASSERT_TRUE(result.run.detection_time_s.has_value());
  EXPECT_FALSE(to_json(result).contains("first_joint"));
  EXPECT_THAT(sentence_of(result), Not(HasSubstr("joint")));
}

// A node that listens: every tenth tick at least, and in the tick of the detection.
TEST(TorqueSpace, TellsEverybodyOnTheBusWhichJointItIs) {
  const RobotDescription robot = by_joint_robot(4, kBoundNm);
  std::vector<hal::Diagnosis> heard;
  std::optional<hal::Microseconds> first_us;
  int expected = 0;
  const auto listen = [&](const hal::Frame& frame, hal::Microseconds time_us) {
    hal::Address address;
    if (address_of(frame, address) != hal::Status::kOk) return;
    if (address.kind != hal::MessageKind::kDiagnosis) return;
    hal::Diagnosis found;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(hal::record_in(frame, 0), data_id_of(address.kind, address.first_node), found,
                     counter),
              hal::Status::kOk);
    EXPECT_EQ(counter, static_cast<std::uint8_t>(expected++));
    if (found.first_joint != 0 && !first_us) first_us = time_us;
    heard.push_back(found);
  };
  const SilResult result = run(robot, scenario_of(robot, {push_on(1, 3 * kBoundNm)}), listen);
  ASSERT_TRUE(first_us.has_value());
  EXPECT_GE(heard.size(), 200U);
  EXPECT_EQ(heard.front().first_joint, 0);
  EXPECT_EQ(heard.back().first_joint, 2);
  EXPECT_EQ(heard.back().worst_joint, 2);
  EXPECT_TRUE(heard.back().level);
  EXPECT_GT(heard.back().error_to_threshold, 1.5F);
  EXPECT_EQ(result.bus.rejected, 0U) << "the drives take no harm";
}

TEST(TorqueSpace, OfThePapersArmIsQuietAndNamesTheJointThatIsPushed) {
  const RobotDescription robot = paper_arm_by_joint();
  Scenario scenario;
  scenario.duration_s = 4.0;
  EXPECT_FALSE(run(robot, scenario).run.detection_time_s.has_value());
  for (int joint = 0; joint < 2; ++joint) {
    scenario.faults = {push_on(joint, 15)};
    const SilResult result = run(robot, scenario);
    ASSERT_TRUE(result.run.first_joint.has_value()) << joint;
    EXPECT_EQ(*result.run.first_joint, joint);
    EXPECT_GE(*result.run.detection_time_s, 1.0);
  }
}

// GIVEN a lasting push WHEN the controller compensates THEN the arm follows its motion better.
TEST(TorqueSpace, CompensatesOnTheJointThatIsPushed) {
  const RobotDescription robot = by_joint_robot(4, kBoundNm);
  Scenario scenario = scenario_of(robot, {push_on(1, 20)});
  scenario.duration_s = 6.0;
  const double without = run(robot, scenario).run.tracking_rms_rad;
  scenario.accommodate = true;
  const SilResult with = run(robot, scenario);
  EXPECT_LT(with.run.tracking_rms_rad, 0.5 * without);
  EXPECT_EQ(with.run.first_joint, 1);
}

// GIVEN a controller that is asked which fault it is THEN it says kind, joint and size, to the
// result and to everybody on the bus.
TEST(TorqueSpace, SaysWhichFaultItIs) {
  RobotDescription robot = by_joint_robot(4, kBoundNm);
  robot.estimator.isolation = true;
  const auto event = [](FaultEventKind kind, int joint, double size) {
    return FaultEvent{.kind = kind, .begin_s = 2.0, .joint = joint, .size = size};
  };
  const struct {
    FaultEvent fault;
    FaultKind kind;
  } cases[] = {{event(FaultEventKind::kFrictionJump, 1, 6 * kBoundNm), FaultKind::kFriction},
               {event(FaultEventKind::kEncoderStuck, 2, 0), FaultKind::kEncoderStuck}};
  for (const auto& [fault, kind] : cases) {
    std::vector<hal::FaultReport> heard;
    const auto listen = [&](const hal::Frame& frame, hal::Microseconds /*time_us*/) {
      hal::Address address;
      if (address_of(frame, address) != hal::Status::kOk) return;
      if (address.kind != hal::MessageKind::kFault) return;
      hal::FaultReport report;
      std::uint8_t counter = 0;
      ASSERT_EQ(decode(hal::record_in(frame, 0), data_id_of(address.kind, address.first_node),
                       report, counter),
                hal::Status::kOk);
      heard.push_back(report);
    };
    Scenario scenario = scenario_of(robot, {fault});
    scenario.duration_s = 7.0;
    const SilResult result = run(robot, scenario, listen);
    ASSERT_TRUE(result.isolated.has_value());
    EXPECT_EQ(result.isolated->kind, kind) << name_of(result.isolated->kind);
    EXPECT_EQ(result.isolated->joint, fault.joint);
    EXPECT_TRUE(result.isolated->decided);
    // One clock: that of the run, in which the fault begins.
    EXPECT_EQ(result.isolated->detection_time_s, result.run.detection_time_s);
    EXPECT_GT(result.isolated->time_s, result.isolated->detection_time_s);
    const double period_s = robot.estimator.period_s;
    const double ticks = (result.isolated->time_s - result.isolated->detection_time_s) / period_s;
    EXPECT_NEAR(ticks, std::round(ticks), 1e-6);
    if (kind == FaultKind::kFriction) {
      EXPECT_NEAR(result.isolated->size, fault.size, 0.2 * fault.size);
    }
    ASSERT_FALSE(heard.empty());
    EXPECT_EQ(heard.back().kind, static_cast<std::uint8_t>(kind));
    EXPECT_EQ(heard.back().joint, fault.joint + 1);
    EXPECT_TRUE(heard.back().decided);
    EXPECT_EQ(to_json(result).at("isolated").at("kind"), name_of(kind));
    EXPECT_THAT(text_of(result), HasSubstr("which fault"));
    EXPECT_EQ(result.bus.rejected, 0U) << "the drives take no harm";
  }
  robot.estimator.isolation = false;
  const SilResult silent = run(robot, scenario_of(robot, {cases[0].fault}));
  EXPECT_FALSE(silent.isolated.has_value());
}

// GIVEN friction WHEN the controller knows that it is THEN it compensates, and the arm follows
// better; GIVEN a push that it takes for a contact THEN it gives way as if it could not compensate.
TEST(TorqueSpace, CompensatesForWhatCompensationIsRightFor) {
  RobotDescription robot = by_joint_robot(4, kBoundNm);
  robot.estimator.isolation = true;
  robot.estimator.learning_rate = 100;
  Scenario scenario = scenario_of(
      robot, {{.kind = FaultEventKind::kFrictionJump, .begin_s = 2.0, .joint = 1, .size = 8}});
  scenario.duration_s = 8.0;
  const double without = run(robot, scenario).run.tracking_rms_rad;
  scenario.accommodate = true;
  EXPECT_LT(run(robot, scenario).run.tracking_rms_rad, 0.5 * without);
  scenario.faults = {{.kind = FaultEventKind::kEncoderStuck, .begin_s = 2.0, .joint = 1}};
  const double stuck = run(robot, scenario).run.tracking_rms_rad;
  scenario.accommodate = false;
  EXPECT_EQ(stuck, run(robot, scenario).run.tracking_rms_rad);
}

// GIVEN drives that send positions alone THEN what M makes of the observer's error is in the
// thresholds: nothing healthy is called a fault, and a fault is still found.
TEST(TorqueSpace, ObservesVelocitiesThatNobodySends) {
  const RobotDescription robot = by_joint_robot(4, kBoundNm);
  Scenario scenario = scenario_of(robot);
  scenario.sends_velocity = false;
  scenario.max_acceleration = 3;
  EXPECT_FALSE(run(robot, scenario).run.detection_time_s.has_value());
  scenario.faults = {push_on(0, 60)};
  scenario.max_acceleration = 3;
  EXPECT_EQ(run(robot, scenario).run.first_joint, 0);
}

// GIVEN a bound that was calibrated on such velocities THEN their error is not in the thresholds
// twice: a push is seen that was hidden by it.
TEST(TorqueSpace, ABoundThatCoversVelocitiesIsTakenAsItIs) {
  RobotDescription robot = by_joint_robot(4, kBoundNm);
  Scenario scenario = scenario_of(robot, {push_on(0, 3 * kBoundNm)});
  scenario.sends_velocity = false;
  scenario.max_acceleration = 30;
  EXPECT_FALSE(run(robot, scenario).run.detection_time_s.has_value());
  robot.bound->covers_velocities = true;
  EXPECT_EQ(run(robot, scenario).run.first_joint, 0);
}

// GIVEN a new arm, of which no bound is known yet THEN it runs, whatever goes on, without a
// detection: the recording to calibrate on.
TEST(TorqueSpace, OfARobotWithoutABoundNothingIsJudged) {
  for (const double fast_alpha : {0.0, 50.0}) {
    RobotDescription robot = by_joint_robot(3, kBoundNm);
    robot.bound.reset();
    robot.estimator.fast_alpha = fast_alpha;
    const RobotDescription never = never_judged(robot);
    const SilResult result = run(never, scenario_of(never, {push_on(1, 10 * kBoundNm)}));
    EXPECT_FALSE(result.run.detection_time_s.has_value());
    EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
  }
  const RobotDescription known = by_joint_robot(3, kBoundNm);
  EXPECT_EQ(never_judged(known).bound->joints[0].value, known.bound->joints[0].value);
}

TEST(TorqueSpace, InDoubleSaysWhatItSaysInFloats) {
  const RobotDescription robot = by_joint_robot(3, kBoundNm);
  Scenario scenario = scenario_of(robot, {push_on(1, 3 * kBoundNm)});
  const SilResult in_float = run(robot, scenario);
  scenario.precision = Precision::kDouble;
  const SilResult in_double = run(robot, scenario);
  EXPECT_EQ(in_double.run.first_joint, 1);
  EXPECT_NEAR(*in_double.run.detection_time_s, *in_float.run.detection_time_s, 0.005);
}

}  // namespace
}  // namespace offnominal::desk::sil
