// Robot files with one to twelve joints at both ends of a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "paper/recording.hpp"
#include "sil/sil_report.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEvent;
using sim::FaultEventKind;
using test::serial_robot;
using testing::HasSubstr;

class AnyRobot : public testing::TestWithParam<int> {};

TEST_P(AnyRobot, FollowsItsMotionAndIsQuietWhileItIsHealthy) {
  const RobotDescription robot = serial_robot(GetParam());
  Scenario scenario = scenario_of(robot);
  scenario.record = true;
  const SilResult result = run(robot, scenario);
  EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
  EXPECT_FALSE(result.run.detection_time_s.has_value());
  // One bound for the norm over all joints: of twelve, what frames and floats round is more of it.
  EXPECT_LT(result.run.max_error_to_threshold_before_fault, GetParam() <= 7 ? 0.5 : 0.8);
  EXPECT_LT(result.run.tracking_rms_rad, 0.01);
  EXPECT_EQ(result.bus.rejected, 0U);
  EXPECT_EQ(result.bus.stale, 0U);
  const Log log = paper::seen_recording_of(robot, result.run.series);
  ASSERT_EQ(log.q.cols(), GetParam());
  for (Eigen::Index joint = 0; joint < log.q.cols(); ++joint) {
    EXPECT_GT(log.q.col(joint).maxCoeff() - log.q.col(joint).minCoeff(), 0.1) << joint;
  }
}

// Radians and metres are not one sum.
TEST(RobotThatTurnsAndSlides, HasATrackingErrorOfEither) {
  RobotDescription robot = serial_robot(3);
  robot.joints[2].joint.type = JointType::kPrismatic;
  const Scenario scenario = scenario_of(robot);
  const SilResult mixed = run(robot, scenario);
  ASSERT_TRUE(mixed.run.tracking_rms_m.has_value());
  EXPECT_GT(*mixed.run.tracking_rms_m, 0);
  EXPECT_GT(mixed.run.tracking_rms_rad, 0);
  EXPECT_THAT(text_of(mixed), testing::ContainsRegex("rad rms, [0-9.]+ m rms"));
  EXPECT_FALSE(run(serial_robot(2), scenario_of(serial_robot(2))).run.tracking_rms_m.has_value());
}

// GIVEN a fault on its last joint WHEN it begins THEN it is seen soon, and not before.
TEST_P(AnyRobot, ShowsAFaultOfItsLastJoint) {
  const RobotDescription robot = serial_robot(GetParam());
  const int last = GetParam() - 1;
  for (const FaultEvent fault :
       {FaultEvent{.kind = FaultEventKind::kDisturbanceTorque, .joint = last, .size = 5.0},
        FaultEvent{.kind = FaultEventKind::kFrictionJump, .joint = last, .size = 5.0},
        FaultEvent{.kind = FaultEventKind::kPayload, .size = 2.0},
        FaultEvent{.kind = FaultEventKind::kEncoderDrift, .joint = last, .size = 1.0}}) {
    FaultEvent at = fault;
    at.begin_s = 1.0;
    const SilResult result = run(robot, scenario_of(robot, {at}));
    ASSERT_TRUE(result.run.detection_time_s.has_value()) << info_of(fault.kind).name;
    EXPECT_GE(*result.run.detection_time_s, 1.0) << info_of(fault.kind).name;
    EXPECT_LT(*result.run.detection_time_s, 1.7) << info_of(fault.kind).name;
  }
}

TEST_P(AnyRobot, IsSafeSoonAfterItsLastDriveFallsSilent) {
  const RobotDescription robot = serial_robot(GetParam());
  const SilResult result = run(
      robot,
      scenario_of(
          robot, {{.kind = FaultEventKind::kSilentNode, .begin_s = 1.0, .joint = GetParam() - 1}}));
  EXPECT_EQ(result.state, hal::ControllerState::kFault);
  ASSERT_TRUE(result.time_to_safe_state_s.has_value());
  EXPECT_LT(*result.time_to_safe_state_s, 0.01);
}

// What the file does not know is more than what a frame rounds.
TEST_P(AnyRobot, ShowsWhatIsHiddenInThePlantAlone) {
  const RobotDescription robot = serial_robot(GetParam());
  Scenario scenario = scenario_of(robot);
  const double known = run(robot, scenario).run.max_error_to_threshold_before_fault;
  RobotEffect spring;
  spring.kind = EffectKind::kJointStiffness;
  spring.joint = static_cast<std::uint8_t>(GetParam() - 1);
  spring.parameters = {1.5, 0.0};
  scenario.hidden = {spring};
  const SilResult result = run(robot, scenario);
  EXPECT_GT(result.run.max_error_to_threshold_before_fault, 2 * known);
  EXPECT_FALSE(result.run.fault_time_s.has_value());
  // The controller's robot may know it: the plant's file says what is there, not what is known.
  RobotDescription improved = robot;
  improved.effects.push_back(spring);
  EXPECT_LT(run(improved, scenario).run.max_error_to_threshold_before_fault, 1.5 * known);
}

INSTANTIATE_TEST_SUITE_P(Joints, AnyRobot,
                         testing::ValuesIn(test::every_nth(std::array{1, 4, 6, 7, kMaxJoints}, 4)));

TEST(AnyRobotInDouble, DoesWhatItDoesInFloats) {
  const RobotDescription robot = serial_robot(3);
  Scenario scenario = scenario_of(robot);
  const SilResult in_float = run(robot, scenario);
  scenario.precision = Precision::kDouble;
  const SilResult in_double = run(robot, scenario);
  EXPECT_EQ(in_double.state, hal::ControllerState::kArmed);
  EXPECT_NE(in_double.run.tracking_rms_rad, in_float.run.tracking_rms_rad);
  EXPECT_NEAR(in_double.run.tracking_rms_rad / in_float.run.tracking_rms_rad, 1, 1e-2);
}

// GIVEN nobody's wish THEN CAN FD carries what is too much for classic CAN, and that alone.
TEST(FramesOfAnyRobot, AreClassicWhereTheyFit) {
  for (const int joints : {1, 2, 3, 6}) {
    const RobotDescription robot = serial_robot(joints);
    Scenario scenario = scenario_of(robot);
    scenario.duration_s = 0.1;
    int fd = 0;
    int classic = 0;
    const SilResult result =
        run(robot, scenario, [&](const hal::Frame& frame, hal::Microseconds /*time_us*/) {
          // Heartbeats are classic ones on every bus.
          const bool heartbeat = frame.id >= 0x700;
          if (!heartbeat) (frame.fd ? fd : classic) += 1;
        });
    EXPECT_EQ(fd > 0, joints > 2) << joints;
    EXPECT_EQ(classic > 0, joints <= 2) << joints;
    EXPECT_LT(result.bus.load, 0.9) << joints;
  }
}

TEST(FramesOfAnyRobot, ClassicOnesThatDoNotFitAreRefused) {
  const RobotDescription robot = serial_robot(6);
  Scenario scenario = scenario_of(robot);
  scenario.format = hal::FrameFormat::kClassic;
  EXPECT_THAT(refusal(robot, scenario),
              testing::AllOf(HasSubstr("6 joints"), HasSubstr("243 %"), HasSubstr("--fd")));
}

TEST(AnyRobotRefused, WhereBothEndsDoNotFitTogether) {
  const RobotDescription robot = serial_robot(3);
  EXPECT_THAT(refusal(robot, scenario_of(serial_robot(4))), HasSubstr("as many as robot serial"));
  EXPECT_THAT(refusal(robot, {}), HasSubstr("found 2 joint(s)"));
  EXPECT_THAT(
      refusal(robot,
              scenario_of(robot,
                          {{.kind = FaultEventKind::kEncoderStuck, .begin_s = 1.0, .joint = 3}})),
      HasSubstr("1 to 3"));
  EXPECT_THAT(
      refusal(robot, scenario_of(robot, {{.kind = FaultEventKind::kNonlinear, .begin_s = 1.0}})),
      HasSubstr("paper's arm"));
}

}  // namespace
}  // namespace offnominal::desk::sil
