// The controller with its default configuration and emulated ODrives, closed loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odrive_arm.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::CanSimpleFirmware;
using hal::ControllerState;
using sim::OdriveAxis;

class Odrive : public testing::TestWithParam<CanSimpleFirmware> {
 protected:
  [[nodiscard]] static OdriveSetup setup() { return {.firmware = GetParam()}; }
  // As setup(), and the drives tell the torque that they give, every millisecond.
  [[nodiscard]] static OdriveSetup telling() {
    OdriveSetup setup = Odrive::setup();
    setup.driver.torque_interval_us = 1000;
    setup.axis.torque_ms = 1;
    return setup;
  }
  // Armed, in closed loop and moving.
  static void start(OdriveArm& arm) {
    ASSERT_TRUE(arm.start());
    arm.run(500);
    ASSERT_EQ(arm.data->state, ControllerState::kArmed) << name_of(arm.data->fault);
    ASSERT_TRUE(arm.data->drives_follow);
    ASSERT_TRUE(arm.gives_torque());
  }
  static void expect_follows_without_alarm(OdriveArm& arm, int ticks) {
    double worst_error = 0;
    for (int i = 0; i < ticks; ++i) {
      arm.tick();
      ASSERT_EQ(arm.data->state, ControllerState::kArmed)
          << name_of(arm.data->fault) << ", tick " << i;
      ASSERT_FALSE(arm.data->output.detector.latched) << "tick " << i;
      if (arm.time_s() > 1) worst_error = std::max(worst_error, arm.tracking_error_rad());
    }
    EXPECT_GT(arm.time_s(), 1.5);
    EXPECT_LT(worst_error, 0.15);
  }
};

INSTANTIATE_TEST_SUITE_P(Firmware, Odrive,
                         testing::Values(CanSimpleFirmware::k05, CanSimpleFirmware::k06),
                         [](const auto& firmware) {
                           return firmware.param == CanSimpleFirmware::k05 ? "v05" : "v06";
                         });

// GIVEN axes with a heartbeat every 100 ms WHEN a healthy arm is armed with the default
// configuration THEN it stays armed, under gravity, without an alarm, and no axis leaves closed
// loop meanwhile.
TEST_P(Odrive, ArmsAndStaysArmedWithTheDefaultConfiguration) {
  OdriveArm arm(setup());
  ASSERT_TRUE(arm.start());
  expect_follows_without_alarm(arm, 5000);
  for (const OdriveAxis& axis : arm.axes) EXPECT_EQ(axis.requests(), 1);
}

TEST_P(Odrive, IsWatchedWithTheTorqueThatItTells) {
  OdriveArm arm(telling());
  ASSERT_TRUE(arm.start());
  expect_follows_without_alarm(arm, 5000);
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_NEAR(static_cast<double>(arm.data->sample.tau[static_cast<Eigen::Index>(j)]),
                arm.joint_torque_nm(j), 1e-3);
  }
}

// GIVEN drives that give less than they are told WHEN they tell so THEN that is no fault of the
// arm; when they do not, it is seen as one.
TEST_P(Odrive, ALimitedTorqueIsKnownWhereItIsTold) {
  for (const bool tells : {true, false}) {
    OdriveArm arm(tells ? telling() : setup());
    start(arm);
    arm.axes[0].max_torque_nm = 4;
    bool detected = false;
    bool was_limited = false;
    for (int i = 0; i < 500 && !detected; ++i) {
      arm.tick();
      detected = arm.data->output.detector.latched;
      was_limited = was_limited || std::abs(arm.axes[0].torque_nm()) > 3.99;
    }
    EXPECT_TRUE(was_limited);
    EXPECT_EQ(detected, !tells);
  }
}

// One that is limited from the start does not hold the arm: time does not even begin.
TEST_P(Odrive, ATorqueThatDoesNotHoldTheArmIsAFaultBeforeTimeBegins) {
  OdriveArm arm(setup());
  arm.axes[0].max_torque_nm = 4;
  ASSERT_TRUE(arm.start());
  arm.run_until(ControllerState::kFault, 2000);
  EXPECT_EQ(arm.data->fault, Fault::kArmNotHeld);
  EXPECT_EQ(arm.data->run_ticks, 0U);
}

TEST_P(Odrive, AFaultOfTheArmIsDetected) {
  OdriveSetup faulty = setup();
  faulty.fault = {.kind = sim::FaultKind::kNonlinear, .time_s = 1.0};
  OdriveArm arm(faulty);
  ASSERT_TRUE(arm.start());
  arm.run(4000);
  EXPECT_TRUE(arm.data->output.detector.latched);
  EXPECT_GT(arm.data->output.detector.detection_time_s, 1.0F);
}

// Two heartbeats in a row may be missing, at the third the drive is silent.
TEST_P(Odrive, ALateHeartbeatIsBorneAndASilentDriveIsNot) {
  OdriveArm arm(setup());
  start(arm);
  OdriveAxis& axis = arm.axes[1];
  axis.silent_heartbeat = true;
  arm.run(145);  // one is missing
  axis.silent_heartbeat = false;
  arm.run(200);
  ASSERT_EQ(arm.data->state, ControllerState::kArmed) << name_of(arm.data->fault);
  axis.silent_heartbeat = true;
  const int ticks = arm.run_until(ControllerState::kFault, 1000);
  EXPECT_LE(ticks, 251);
  EXPECT_EQ(arm.data->fault, Fault::kDriveSilent);
}

TEST_P(Odrive, ATorqueThatIsNoLongerToldIsASilentDrive) {
  OdriveSetup quiet = telling();
  quiet.axis.torque_ms = 0;
  OdriveArm never(quiet);
  EXPECT_FALSE(never.start()) << "without the torque that it was promised";
  OdriveArm arm(telling());
  start(arm);
  arm.axes[0].silent_torque = true;
  EXPECT_LE(arm.run_until(ControllerState::kFault, 10), 3);
  EXPECT_EQ(arm.data->fault, Fault::kDriveSilent);
}

TEST_P(Odrive, AnErrorOfTheDriveLeadsToTheSafeState) {
  OdriveArm arm(setup());
  start(arm);
  arm.axes[0].fail(OdriveAxis::kMotorFailed);
  EXPECT_LE(arm.run_until(ControllerState::kFault, 1000), 101);
  EXPECT_EQ(arm.data->fault, Fault::kDriveReported);
  arm.run(5);
  EXPECT_FALSE(arm.gives_torque());
}

TEST_P(Odrive, ADriveThatDropsOutOfClosedLoopIsNotFollowing) {
  OdriveArm arm(setup());
  start(arm);
  arm.axes[1].drop_out();
  EXPECT_LE(arm.run_until(ControllerState::kFault, 1000), 101);
  EXPECT_EQ(arm.data->fault, Fault::kDriveNotFollowing);
  arm.run(5);
  EXPECT_FALSE(arm.gives_torque());
}

// Until then nothing is watched and time stands: no alarm of an arm that its drives do not hold.
TEST_P(Odrive, ADriveThatNeverEntersClosedLoopIsNotFollowing) {
  OdriveArm arm(setup());
  arm.axes[1].refuses = true;
  ASSERT_TRUE(arm.start());
  const auto& config = arm.controller.config();
  const auto most = (config.time_to_follow_us + arm.drives().drive_max_age_us()) / 1000;
  for (int i = 0; i < most; ++i) {
    arm.tick();
    ASSERT_EQ(arm.data->state, ControllerState::kArmed) << "tick " << i;
    ASSERT_EQ(arm.data->run_ticks, 0U);
    ASSERT_FALSE(arm.data->output.detector.latched);
  }
  arm.run(2);
  EXPECT_EQ(arm.data->fault, Fault::kDriveNotFollowing);
}

TEST_P(Odrive, AnAxisWithoutCalibrationSaysSo) {
  OdriveSetup uncalibrated = setup();
  uncalibrated.axis.calibrated = false;
  OdriveArm arm(uncalibrated);
  ASSERT_TRUE(arm.start());
  arm.run_until(ControllerState::kFault, 300);
  EXPECT_EQ(arm.data->fault, Fault::kDriveReported);
}

TEST_P(Odrive, ALostRequestIsMadeAgain) {
  OdriveArm arm(setup());
  ASSERT_TRUE(arm.start());
  arm.lose_commands(true);
  arm.run(2);
  arm.lose_commands(false);
  expect_follows_without_alarm(arm, 3000);
  for (const OdriveAxis& axis : arm.axes) EXPECT_EQ(axis.requests(), 1);
}

// GIVEN a run that ended WHEN the controller is armed again at once THEN a heartbeat of before does
// not count: the axes are waited for anew.
TEST_P(Odrive, AHeartbeatOfBeforeSaysNothingAboutTheNextRun) {
  OdriveSetup anywhere = setup();  // where the run before has left the arm
  anywhere.controller.arming.position_window.fill(1);
  anywhere.controller.arming.speed.fill(5);
  OdriveArm arm(anywhere);
  start(arm);
  ASSERT_TRUE(arm.controller.disarm(*arm.data));
  arm.tick();
  ASSERT_EQ(arm.arm(), Fault::kNone);
  arm.run(3);
  EXPECT_FALSE(arm.data->drives_follow);
  arm.run(300);
  EXPECT_EQ(arm.data->state, ControllerState::kArmed) << name_of(arm.data->fault);
  EXPECT_TRUE(arm.data->drives_follow);
}

TEST_P(Odrive, TheDrivesLetGoWithoutAController) {
  OdriveSetup watched = setup();
  watched.axis.watchdog_ms = 50;
  OdriveArm arm(watched);
  start(arm);
  arm.controller_runs = false;
  arm.run(52);
  EXPECT_FALSE(arm.gives_torque());
}

}  // namespace
}  // namespace offnominal::test
