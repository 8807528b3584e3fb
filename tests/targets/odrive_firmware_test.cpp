// Firmware of a robot file whose drives are ODrives: what speaks to them comes out of the header
// that the command writes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <offnominal/controller/joint_firmware.hpp>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <optional>
#include <type_traits>

#include "offnominal/sim/bus/odrive_drives.hpp"

namespace offnominal::test {
namespace {

using Net = hal::InProcessNet<2>;
using Firmware = controller::JointFirmware<Net::Port, float>;
static_assert(std::is_same_v<Firmware::Drives, hal::CanSimpleDrives<2>>);

Reference<2, float> at_rest(double /*time_s*/) { return {}; }

// Emulated axes as the header says, of an arm that lies still, stretched out.
class StillArm {
 public:
  void tick() {
    now_us_ += Firmware::kPeriodUs;
    net_.set_time(now_us_);
    std::array<hal::ReceivedFrame, 16> come;
    const std::size_t count = arm_.receive(come);
    for (std::size_t i = 0; i < count; ++i) drives.take(come[i]);
    drives.tick(now_us_);
    const std::array<sim::Drives::Reading, 2> readings{hal::EncoderReading{0, 0, true},
                                                       hal::EncoderReading{0, 0, true}};
    std::array<hal::Frame, sim::Drives::kMostFrames> frames;
    const std::size_t made = drives.frames(readings, std::array{0.0, 0.0}, frames);
    for (std::size_t i = 0; i < made; ++i) static_cast<void>(arm_.send(frames[i], now_us_));
    firmware.tick(now_us_, 0, at_rest);
  }

  sim::OdriveDrives drives{robot_model::kDriveValues,
                           {.joints = 2, .link = {.period_us = Firmware::kPeriodUs}}};

 private:
  Net net_;
  Net::Port arm_ = net_.port(0);
  Net::Port bus_ = net_.port(1);
  hal::Microseconds now_us_ = 0;

 public:
  Firmware firmware{bus_};
};

TEST(FirmwareWithOdrives, IsMadeOfTheHeader) {
  EXPECT_EQ(hal::CanSimple::config_of(robot_model::kDriveValues).torque_interval_us, 1000);
  const hal::CanSimpleAxis second = hal::CanSimple::axis_of(robot_model::kDriveValues, 1);
  EXPECT_EQ(second.node, 44);
  EXPECT_EQ(second.joint_per_turn, -0.62832F);
  EXPECT_EQ(second.firmware, hal::CanSimpleFirmware::k05);
  EXPECT_EQ(second.motor_nm_per_ampere, 0.05F);
}

TEST(FirmwareWithOdrives, HoldsTheArmByThem) {
  StillArm arm;
  ASSERT_EQ(arm.firmware.start(), Status::kOk);
  int ticks = 0;
  for (; ticks < 300 && arm.firmware.data().state != hal::ControllerState::kPassive; ++ticks) {
    arm.tick();
  }
  ASSERT_LT(ticks, 300) << "every heartbeat is heard after 0.1 s";
  ASSERT_EQ(arm.firmware.arm(at_rest), controller::Fault::kNone);
  for (int i = 0; i < 500; ++i) arm.tick();
  EXPECT_EQ(arm.firmware.data().state, hal::ControllerState::kArmed)
      << name_of(arm.firmware.data().fault);
  EXPECT_TRUE(arm.drives.all_in_torque_mode());
  // 9.81 m/s^2 (0.5 kg 1 m + 2 kg 2 m) at the first joint.
  EXPECT_NEAR(arm.drives.torque_nm(0, 0), 44.145, 0.05);
}

}  // namespace
}  // namespace offnominal::test
