// The code of ODrive's protocol against ODrive's own DBC file, bit by bit of what matters.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>

#include "log/dbc.hpp"
#include "support/recordings.hpp"

namespace offnominal::hal {
namespace {

using Drives = CanSimpleDrives<2>;
using desk::Dbc;
using desk::DbcMessage;
using desk::DbcSignal;

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

class CanSimple : public testing::Test {
 protected:
  void SetUp() override {
    const auto file = test_file();
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "SKIP_ no " << file;
    dbc = desk::read_dbc(file);
  }
  static std::filesystem::path test_file() {
    return offnominal::test::recordings_dir() / "can_odrive_dbc/odrive-cansimple.dbc";
  }
  const DbcMessage& message(std::uint32_t id) const {
    const DbcMessage* found = dbc.find(id, false);
    if (found == nullptr) throw std::runtime_error("no message " + std::to_string(id));
    return *found;
  }
  std::map<std::string, double> decoded(const Frame& frame) const {
    std::map<std::string, double> values;
    for (const DbcSignal& signal : message(frame.id).signals) {
      values[signal.name] =
          signal.value_in(std::span<const std::uint8_t>(frame.data).first(frame.length));
    }
    return values;
  }
  // Sets the bits of an integer signal.
  void set(Frame& frame, const std::string& name, std::uint64_t value) const {
    for (const DbcSignal& signal : message(frame.id).signals) {
      if (signal.name != name) continue;
      for (int bit = 0; bit < signal.length; ++bit) {
        const auto at = static_cast<std::size_t>(signal.start_bit + bit);
        const auto mask = static_cast<std::uint8_t>(1U << (at % 8));
        auto& byte = frame.data[at / 8];
        byte = static_cast<std::uint8_t>((value >> bit & 1U) != 0 ? byte | mask : byte & ~mask);
      }
      return;
    }
    throw std::runtime_error("no signal " + name);
  }
  Frame frame_with(std::uint32_t id) const {
    Frame frame;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(message(id).length);
    return frame;
  }

  Dbc dbc;
  // Axis 0 turns the first joint, axis 1 the second through a gear of 10 that reverses.
  static constexpr std::array<CanSimpleAxis, 2> kAxes{
      {{0, kTurn, CanSimpleFirmware::k05, 0.05F}, {1, -kTurn / 10, CanSimpleFirmware::k05, 0.05F}}};
  Drives drives{{}, kAxes};
};

TEST_F(CanSimple, ReadsEncoderEstimates) {
  for (const std::uint32_t axis : {0U, 1U}) {
    Frame frame = frame_with(axis << 5U | 9U);
    set(frame, "Pos_Estimate", std::bit_cast<std::uint32_t>(1.5F));
    set(frame, "Vel_Estimate", std::bit_cast<std::uint32_t>(-0.25F));
    EXPECT_EQ(drives.feedback(axis, 0).encoder, SourceState::kNeverSeen);
    ASSERT_EQ(drives.take({frame, 1000}), Status::kOk);
    const JointFeedback feedback = drives.feedback(axis, 1000);
    const float per_turn = axis == 0 ? kTurn : -kTurn / 10;
    EXPECT_FLOAT_EQ(feedback.reading.position, 1.5F * per_turn);
    EXPECT_FLOAT_EQ(feedback.reading.velocity, -0.25F * per_turn);
    EXPECT_EQ(feedback.encoder, SourceState::kValid);
    EXPECT_EQ(drives.feedback(axis, 3500).encoder, SourceState::kValid);
    EXPECT_EQ(drives.feedback(axis, 3501).encoder, SourceState::kStale);
  }
}

TEST_F(CanSimple, ReadsHeartbeats) {
  Frame frame = frame_with(1);
  set(frame, "Axis_State", 8);
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  EXPECT_EQ(drives.feedback(0, 0).status.mode, DriveMode::kTorque);
  EXPECT_EQ(drives.feedback(0, 0).status.flags, 0);
  EXPECT_EQ(drives.feedback(0, 250001).drive, SourceState::kStale);
  const auto flags_with = [&](const char* signal, std::uint64_t value) {
    Frame bad = frame;
    set(bad, signal, value);
    EXPECT_EQ(drives.take({bad, 0}), Status::kOk);
    return drives.feedback(0, 0).status.flags;
  };
  EXPECT_EQ(flags_with("Axis_Error", 0x800), kDriveFault);
  EXPECT_EQ(flags_with("Motor_Error_Flag", 1), kDriveFault);
  EXPECT_EQ(flags_with("Controller_Error_Flag", 1), kDriveFault);
  EXPECT_EQ(flags_with("Encoder_Error_Flag", 1), kEncoderFault);
  set(frame, "Axis_State", 1);
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  EXPECT_EQ(drives.feedback(0, 0).status.mode, DriveMode::kOff);
}

// Bytes 5 and 6 of firmware 0.6 are the result of the last procedure and "trajectory done".
TEST_F(CanSimple, ReadsHeartbeatsOfFirmware06) {
  auto axes = kAxes;
  axes[0].firmware = CanSimpleFirmware::k06;
  drives = Drives({}, axes);
  Frame frame;
  frame.id = 1;
  frame.length = 8;
  frame.data = {0, 0, 0, 0, 8, 1, 1, 0};
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  EXPECT_EQ(drives.feedback(0, 0).status.mode, DriveMode::kTorque);
  EXPECT_EQ(drives.feedback(0, 0).status.flags, 0);
  frame.data[3] = 1;  // WATCHDOG_TIMER_EXPIRED
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  EXPECT_EQ(drives.feedback(0, 0).status.flags, kDriveFault);
}

TEST_F(CanSimple, ReadsTheCurrentOfFirmware05AsTorque) {
  Frame frame = frame_with(32U | 20U);
  set(frame, "Iq_Measured", std::bit_cast<std::uint32_t>(-4.0F));
  EXPECT_EQ(drives.take({frame, 0}), Status::kUnknownId) << "nobody has said that it is sent";
  drives = Drives({.torque_interval_us = 1000}, kAxes);
  Frame heartbeat = frame_with(32U | 1U);
  ASSERT_EQ(drives.take({heartbeat, 0}), Status::kOk);
  EXPECT_EQ(drives.feedback(1, 0).drive, SourceState::kNeverSeen);
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  // 0.05 N m/A, through a gear of 10 that reverses.
  EXPECT_FLOAT_EQ(drives.feedback(1, 0).status.applied_torque, 2.0F);
  EXPECT_EQ(drives.feedback(1, 2500).drive, SourceState::kValid);
  EXPECT_EQ(drives.feedback(1, 2501).drive, SourceState::kStale);
  set(frame, "Iq_Measured", 0x7F800000);
  EXPECT_EQ(drives.take({frame, 0}), Status::kInvalidValue);
  // Without its constant a current says nothing of the torque: the drive stays unheard.
  auto axes = kAxes;
  axes[1].motor_nm_per_ampere = 0;
  drives = Drives({.torque_interval_us = 1000}, axes);
  EXPECT_EQ(drives.take({frame, 0}), Status::kUnknownId);
}

TEST_F(CanSimple, ReadsTheTorqueOfFirmware06) {
  auto axes = kAxes;
  axes[0].firmware = CanSimpleFirmware::k06;
  drives = Drives({.torque_interval_us = 1000}, axes);
  Frame frame;
  frame.length = 8;
  frame.id = 0x1C;
  to_little_endian(std::bit_cast<std::uint32_t>(9.0F),
                   std::span<std::uint8_t>(frame.data).first(4));
  to_little_endian(std::bit_cast<std::uint32_t>(-1.5F),
                   std::span<std::uint8_t>(frame.data).subspan(4, 4));
  ASSERT_EQ(drives.take({frame, 0}), Status::kOk);
  EXPECT_FLOAT_EQ(drives.feedback(0, 0).status.applied_torque, -1.5F) << "estimate, not target";
  // The other axis has firmware 0.5: its ADC voltage.
  frame.id = 32U | 0x1CU;
  EXPECT_EQ(drives.take({frame, 0}), Status::kUnknownId);
}

// An axis that is asked for closed loop while it is in it leaves it and enters again.
TEST_F(CanSimple, AsksForClosedLoopOnceAndSendsTorqueInEveryTick) {
  constexpr Microseconds kLater = Drives::kStateTimeUs;
  std::array<TorqueCommand, 2> commands{{{DriveMode::kTorque, 2.0F}, {DriveMode::kTorque, 3.0F}}};
  std::array<Frame, Drives::kMaxOutgoing> frames;
  ASSERT_EQ(drives.outgoing(commands, {.ticks = 1}, frames), 4U);
  EXPECT_EQ(decoded(frames[0]).at("Input_Torque"), 2.0);
  EXPECT_EQ(decoded(frames[1]).at("Axis_Requested_State"), 8);
  EXPECT_NEAR(decoded(frames[2]).at("Input_Torque"), -0.3, 1e-6);
  EXPECT_EQ(drives.feedback(0, 0).status.applied_torque, 0.0F) << "it is not in closed loop";
  for (std::uint32_t tick = 2; tick < 100; ++tick) {
    ASSERT_EQ(drives.outgoing(commands, {.ticks = tick}, frames), 2U) << tick;
    ASSERT_EQ(frames[0].id, 14U);
    ASSERT_EQ(frames[1].id, 32U + 14U);
  }
  const auto heartbeat = [&](std::uint32_t axis, std::uint64_t state, Microseconds time_us) {
    Frame frame = frame_with(axis << 5U | 1U);
    set(frame, "Axis_State", state);
    ASSERT_EQ(drives.take({frame, time_us}), Status::kOk);
  };
  // So soon a heartbeat may be about what was before.
  heartbeat(0, 8, kLater - 1);
  heartbeat(1, 1, kLater - 1);
  EXPECT_EQ(drives.feedback(0, kLater).status.mode, DriveMode::kOff);
  ASSERT_EQ(drives.outgoing(commands, {.ticks = 100}, frames), 2U);
  // One is in closed loop, the other has not heard.
  heartbeat(0, 8, kLater);
  heartbeat(1, 1, kLater);
  EXPECT_EQ(drives.feedback(0, kLater).status.mode, DriveMode::kTorque);
  EXPECT_EQ(drives.feedback(0, kLater).status.applied_torque, 2.0F);
  ASSERT_EQ(drives.outgoing(commands, {.ticks = 101}, frames), 3U);
  EXPECT_EQ(frames[2].id, 32U + 7U);
  ASSERT_EQ(drives.outgoing(commands, {.ticks = 102}, frames), 2U);
}

TEST_F(CanSimple, AsksForIdleAndNoTorqueUntilTheAxisSaysSo) {
  std::array<TorqueCommand, 2> commands{{{DriveMode::kTorque, 2.0F}, {}}};
  std::array<Frame, Drives::kMaxOutgoing> frames;
  ASSERT_EQ(drives.outgoing(commands, {.ticks = 1}, frames), 2U) << "the other one is idle";
  Frame frame = frame_with(1);
  set(frame, "Axis_State", 8);
  ASSERT_EQ(drives.take({frame, Drives::kStateTimeUs}), Status::kOk);
  for (const TorqueCommand& off : {TorqueCommand{}, TorqueCommand{DriveMode::kDamping, 0},
                                   TorqueCommand{DriveMode::kTorque, NAN}}) {
    commands[0] = off;
    ASSERT_EQ(drives.outgoing(commands, {.ticks = 3}, frames), 2U);
    EXPECT_EQ(decoded(frames[0]).at("Input_Torque"), 0.0);
    EXPECT_EQ(decoded(frames[1]).at("Axis_Requested_State"), 1);
    EXPECT_EQ(drives.feedback(0, 0).status.applied_torque, 0.0F);
  }
  set(frame, "Axis_State", 1);
  ASSERT_EQ(drives.take({frame, Drives::kStateTimeUs}), Status::kOk);
  EXPECT_EQ(drives.outgoing(commands, {.ticks = 4}, frames), 0U);
  EXPECT_EQ(drives.outgoing(commands, {.ticks = 10}, frames), 4U);
}

TEST_F(CanSimple, RefusesWhatIsNoneOfItsFrames) {
  Frame frame = frame_with(9);
  frame.length = 7;
  EXPECT_EQ(drives.take({frame, 0}), Status::kWrongLength);
  frame = frame_with(9);
  frame.remote = true;
  EXPECT_EQ(drives.take({frame, 0}), Status::kNotADataFrame);
  frame = frame_with(9);
  frame.extended = true;
  EXPECT_EQ(drives.take({frame, 0}), Status::kUnknownId);
  frame.extended = false;
  frame.id = 5U << 5U | 9U;
  EXPECT_EQ(drives.take({frame, 0}), Status::kUnknownId);
  frame = frame_with(9);
  set(frame, "Pos_Estimate", 0x7FC00000);
  EXPECT_EQ(drives.take({frame, 0}), Status::kInvalidValue);
  EXPECT_EQ(drives.feedback(0, 0).encoder, SourceState::kNeverSeen);
}

}  // namespace
}  // namespace offnominal::hal
