// The class that firmware is made of, on this machine, with the model that the command writes of an
// arm that ticks every 5 ms.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <offnominal/controller/joint_firmware.hpp>
#include <offnominal/controller/static_object.hpp>
#include <offnominal/hal/bus/in_process_bus.hpp>

namespace offnominal::test {
namespace {

using Net = hal::InProcessNet<2>;
using Firmware = controller::JointFirmware<Net::Port, float>;
constexpr auto kCount = static_cast<std::size_t>(Firmware::kJoints);

// Encoders at rest, stretched out, and drives that give what they were told.
class HeldArm {
 public:
  void tick(bool sends = true) {
    ++counter_;
    net_.set_time(static_cast<hal::Microseconds>(++ticks_) * Firmware::kPeriodUs);
    if (sends) send();
    firmware.tick(net_.now(), 0, at_rest);
  }
  controller::Fault arm() { return firmware.arm(at_rest); }
  [[nodiscard]] hal::ControllerState state() const { return firmware.data().state; }
  void tick_until(hal::ControllerState wanted) {
    for (int i = 0; i < 20 && state() != wanted; ++i) tick();
  }

 private:
  Net net_;
  Net::Port arm_ = net_.port(0);
  Net::Port bus_ = net_.port(1);

 public:
  Firmware firmware{bus_};

 private:
  static Reference<Firmware::kJoints, float> at_rest(double /*time_s*/) { return {}; }

  void send() {
    for (std::size_t j = 0; j < kCount; ++j) {
      const auto node = static_cast<std::uint8_t>(j);
      const float torque = firmware.data().commands[j].torque + beside_nm;
      hal::Record record{};
      ASSERT_EQ(encode(hal::EncoderReading{0, 0, true}, counter_,
                       hal::data_id_of(hal::MessageKind::kEncoder, node), record),
                hal::Status::kOk);
      ASSERT_EQ(arm_.send(hal::frame_of(hal::MessageKind::kEncoder, node, record), net_.now()),
                hal::Status::kOk);
      ASSERT_EQ(encode(hal::DriveStatus{firmware.data().commands[j].mode, 0, torque}, counter_,
                       hal::data_id_of(hal::MessageKind::kDriveStatus, node), record),
                hal::Status::kOk);
      ASSERT_EQ(arm_.send(hal::frame_of(hal::MessageKind::kDriveStatus, node, record), net_.now()),
                hal::Status::kOk);
    }
  }

  std::uint8_t counter_ = 0;
  int ticks_ = 0;

 public:
  float beside_nm = 0;  // that the drives say they give on top
};

TEST(JointFirmware, ItsTimesFollowTheRobotsPeriod) {
  EXPECT_EQ(Firmware::kPeriodUs, 5000);
  HeldArm arm;
  ASSERT_EQ(arm.firmware.start(), Status::kOk);
  arm.tick_until(hal::ControllerState::kPassive);
  ASSERT_EQ(arm.arm(), controller::Fault::kNone);
  for (int i = 0; i < 100; ++i) arm.tick();
  EXPECT_EQ(arm.state(), hal::ControllerState::kArmed);
  // 9.81 m/s^2 (0.5 kg 1 m + 2 kg 2 m) at the first joint.
  EXPECT_NEAR(arm.firmware.data().commands[0].torque, 44.145F, 0.01F);
  EXPECT_EQ(arm.firmware.data().unsent_frames, 0U);
}

TEST(JointFirmware, AFaultEndsWhenItIsCleared) {
  HeldArm arm;
  ASSERT_EQ(arm.firmware.start(), Status::kOk);
  EXPECT_FALSE(arm.firmware.clear_fault()) << "there is none";
  arm.tick_until(hal::ControllerState::kPassive);
  ASSERT_EQ(arm.arm(), controller::Fault::kNone);
  arm.tick();
  // Two ticks without frames are borne, the third is not.
  arm.tick(false);
  arm.tick(false);
  ASSERT_EQ(arm.state(), hal::ControllerState::kArmed);
  arm.tick(false);
  ASSERT_EQ(arm.state(), hal::ControllerState::kFault);
  for (int i = 0; i < 20; ++i) arm.tick();
  ASSERT_EQ(arm.state(), hal::ControllerState::kFault) << "it is latched";
  EXPECT_EQ(arm.arm(), controller::Fault::kNotPassive);

  ASSERT_TRUE(arm.firmware.clear_fault());
  arm.tick_until(hal::ControllerState::kPassive);
  ASSERT_EQ(arm.arm(), controller::Fault::kNone);
  arm.tick();
  EXPECT_EQ(arm.state(), hal::ControllerState::kArmed);
  EXPECT_TRUE(arm.firmware.disarm());
  EXPECT_EQ(arm.state(), hal::ControllerState::kPassive);
}

// The robot's constants do not say what is done at a detection: firmware does.
TEST(JointFirmware, DoesAtADetectionWhatItsFirmwareSays) {
  for (const bool slows : {false, true}) {
    HeldArm arm;
    auto config = Firmware::config();
    if (slows) config.at_detection = controller::AtDetection::kSlow;
    ASSERT_EQ(arm.firmware.start(config), Status::kOk);
    arm.tick_until(hal::ControllerState::kPassive);
    ASSERT_EQ(arm.arm(), controller::Fault::kNone);
    for (int i = 0; i < 100; ++i) arm.tick();
    ASSERT_EQ(arm.state(), hal::ControllerState::kArmed);
    arm.beside_nm = 60;  // in vain: the arm does not move
    for (int i = 0; i < 200; ++i) arm.tick();
    EXPECT_TRUE(arm.firmware.data().output.detector.acts);
    EXPECT_EQ(arm.firmware.data().slows, slows);
  }
  HeldArm arm;
  auto config = Firmware::config();
  config.slow_down.to = 2;
  EXPECT_EQ(arm.firmware.start(config), Status::kInvalidLimit);
}

TEST(StaticObject, HoldsWhatItWasMadeOf) {
  static constinit controller::StaticObject<std::array<int, 2>> object;
  object.make(std::array<int, 2>{3, 4});
  EXPECT_EQ((*object)[1], 4);
  EXPECT_EQ(object->front(), 3);
}

}  // namespace
}  // namespace offnominal::test
