// Robot files whose drives are ODrives, at both ends of a bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEventKind;
using testing::HasSubstr;

// Two joints every millisecond; seven as often as classic CAN lets them.
class Odrives : public testing::TestWithParam<std::tuple<int, std::string>> {
 protected:
  [[nodiscard]] static int joints() { return std::get<0>(GetParam()); }
  [[nodiscard]] static RobotDescription robot() {
    return test::odrive_robot(joints(), joints() == 2 ? 1 : 5, std::get<1>(GetParam()));
  }
};

TEST_P(Odrives, FollowTheMotionAndAreQuietWhileTheArmIsHealthy) {
  std::set<std::uint32_t> nodes;
  bool classic = true;
  const SilResult result =
      run(robot(), scenario_of(robot()), [&](const hal::Frame& frame, hal::Microseconds /*us*/) {
        nodes.insert(frame.id >> 5U);
        classic = classic && !frame.fd && !frame.extended;
      });
  EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
  EXPECT_FALSE(result.run.detection_time_s.has_value());
  EXPECT_LT(result.run.max_error_to_threshold_before_fault, 0.9);
  EXPECT_LT(result.run.tracking_rms_rad, 0.02);
  EXPECT_EQ(result.bus.stale, 0U);
  EXPECT_LT(result.bus.load, 0.9);
  EXPECT_TRUE(classic);
  EXPECT_EQ(nodes.size(), static_cast<std::size_t>(joints()));
  EXPECT_TRUE(nodes.contains(60));
}

// GIVEN a fault on its last joint WHEN it begins THEN it is seen soon, and not before.
TEST_P(Odrives, ShowAFaultOfTheLastJoint) {
  const SilResult result =
      run(robot(), scenario_of(robot(), {{.kind = FaultEventKind::kDisturbanceTorque,
                                          .begin_s = 1.0,
                                          .joint = joints() - 1,
                                          .size = 5.0}}));
  ASSERT_TRUE(result.run.detection_time_s.has_value());
  EXPECT_GE(*result.run.detection_time_s, 1.0);
  EXPECT_LT(*result.run.detection_time_s, 1.7);
}

// The axis that hears nothing lets go by its own watch-dog, 50 ms later; the others are told.
TEST_P(Odrives, LetGoWhereTheLastOfThemFallsSilent) {
  const SilResult result = run(
      robot(),
      scenario_of(robot(),
                  {{.kind = FaultEventKind::kSilentNode, .begin_s = 1.0, .joint = joints() - 1}}));
  EXPECT_EQ(result.state, hal::ControllerState::kFault);
  EXPECT_EQ(result.fault, controller::Fault::kEncoderSilent) << controller::name_of(result.fault);
  ASSERT_TRUE(result.time_to_safe_state_s.has_value());
  EXPECT_GT(*result.time_to_safe_state_s, 0.045);
  EXPECT_LT(*result.time_to_safe_state_s, 0.07);
}

TEST_P(Odrives, LetGoWhereAnEncoderFails) {
  const SilResult result =
      run(robot(),
          scenario_of(
              robot(),
              {{.kind = FaultEventKind::kEncoderDropout, .begin_s = 1.0, .joint = joints() - 1}}));
  EXPECT_EQ(result.state, hal::ControllerState::kFault);
  ASSERT_TRUE(result.time_to_safe_state_s.has_value());
  EXPECT_LT(*result.time_to_safe_state_s, 0.12);
}

INSTANTIATE_TEST_SUITE_P(JointsAndFirmware, Odrives,
                         testing::Combine(testing::Values(2, 7),
                                          testing::Values(std::string("0.5"), std::string("0.6"))),
                         [](const auto& odrives) {
                           return std::to_string(std::get<0>(odrives.param)) + "_v" +
                                  std::get<1>(odrives.param)[2];
                         });

// Frames of this protocol have nothing by which a forged one is told from a true one.
TEST(OdrivesOnAFaultyBus, RejectNothingThatIsForged) {
  const std::vector<FaultEvent> forged{
      {.kind = FaultEventKind::kForgedFrames, .begin_s = 1.0, .size = 4}};
  for (const bool odrives : {true, false}) {
    const RobotDescription robot =
        odrives ? test::odrive_robot(2, 1, "0.6") : test::serial_robot(2);
    EXPECT_EQ(run(robot, scenario_of(robot, forged)).bus.rejected > 0, !odrives);
  }
}

TEST(OdrivesRefused, WhereTheProtocolCannotDoWhatIsWished) {
  const RobotDescription robot = test::odrive_robot(2, 1, "0.6");
  Scenario fd = scenario_of(robot);
  fd.format = hal::FrameFormat::kFd;
  EXPECT_THAT(refusal(robot, fd),
              testing::AllOf(HasSubstr("CAN FD: found drives that speak can_simple"),
                             HasSubstr("allowed: classic CAN")));
  Scenario observed = scenario_of(robot);
  observed.sends_velocity = false;
  EXPECT_THAT(refusal(robot, observed), HasSubstr("velocity: found observed"));
  const RobotDescription many = test::odrive_robot(7, 1, "0.6");
  EXPECT_THAT(refusal(many, scenario_of(many)),
              testing::AllOf(HasSubstr("classic CAN: found 7 joints at 1000 ticks a second"),
                             HasSubstr("fewer ticks")));
}

// The drives are those of the controller's file, whatever stands in the plant's.
TEST(OdrivesInTwoFiles, AreThoseOfTheControllersFile) {
  const RobotDescription robot = test::odrive_robot(2, 1, "0.6");
  const SilResult result = run(robot, scenario_of(test::serial_robot(2)));
  EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
}

}  // namespace
}  // namespace offnominal::desk::sil
