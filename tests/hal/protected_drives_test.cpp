#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <vector>

namespace offnominal::hal {
namespace {

constexpr std::size_t kArmJoints = 3;
using Drives = ProtectedDrives<kArmJoints>;

// Sources that trust the first record, with ages of their own.
constexpr SourceConfig kEncoders{.max_age_us = 2000, .sequence_needed = 1};
constexpr SourceConfig kStatuses{.max_age_us = 5000, .sequence_needed = 1};

Drives drives(FrameFormat format = FrameFormat::kClassic) { return {kEncoders, kStatuses, format}; }

template <typename Message>
Record sealed(MessageKind kind, std::size_t node, const Message& message, std::uint8_t counter) {
  Record record{};
  EXPECT_EQ(encode(message, counter, data_id_of(kind, static_cast<std::uint8_t>(node)), record),
            Status::kOk);
  return record;
}
template <typename Message>
Frame frame_with(MessageKind kind, std::size_t node, const Message& message, std::uint8_t counter) {
  return frame_of(kind, static_cast<std::uint8_t>(node), sealed(kind, node, message, counter));
}
Frame reading_of(std::size_t node, float position, std::uint8_t counter) {
  return frame_with(MessageKind::kEncoder, node, EncoderReading{position, 0.5F, true}, counter);
}

// What a joint's drive finds in the frames of a tick: its command, and the counter with it.
struct Received {
  TorqueCommand command;
  std::uint8_t counter = 0;
};
Received received(std::span<const Frame> frames, std::size_t joint) {
  for (const Frame& frame : frames) {
    Address address;
    EXPECT_EQ(address_of(frame, address), Status::kOk);
    const bool holds = joint >= address.first_node && joint < address.first_node + address.count;
    if (address.kind != MessageKind::kTorqueCommand || !holds) continue;
    Received found;
    EXPECT_EQ(decode(record_in(frame, joint - address.first_node),
                     data_id_of(address.kind, static_cast<std::uint8_t>(joint)), found.command,
                     found.counter),
              Status::kOk);
    return found;
  }
  ADD_FAILURE() << "no command for joint " << joint;
  return {};
}

TEST(PackedRecords, HaveAFrameEachInClassicCan) {
  std::vector<Record> records(3);
  for (std::size_t i = 0; i < records.size(); ++i) records[i].fill(static_cast<std::uint8_t>(i));
  std::array<Frame, 3> frames;
  ASSERT_EQ(pack(MessageKind::kDriveStatus, records, FrameFormat::kClassic, frames), 3U);
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(frames[i].id, id_of(MessageKind::kDriveStatus, static_cast<std::uint8_t>(i)));
    EXPECT_FALSE(frames[i].fd);
    EXPECT_TRUE(std::ranges::equal(record_in(frames[i], 0), records[i]));
  }
}

TEST(PackedRecords, GoEightTogetherInCanFd) {
  for (const std::size_t count : {1U, 8U, 9U, 16U, 20U}) {
    std::vector<Record> records(count);
    for (std::size_t i = 0; i < count; ++i) records[i].fill(static_cast<std::uint8_t>(i + 1));
    std::array<Frame, 3> frames;
    const std::size_t wanted = (count + 7) / 8;
    ASSERT_EQ(pack(MessageKind::kEncoder, records, FrameFormat::kFd, frames), wanted) << count;
    for (std::size_t i = 0; i < count; ++i) {
      Address address;
      ASSERT_EQ(address_of(frames[i / 8], address), Status::kOk);
      EXPECT_TRUE(frames[i / 8].fd);
      EXPECT_EQ(address.first_node, i / 8 * 8);
      EXPECT_TRUE(std::ranges::equal(record_in(frames[i / 8], i % 8), records[i]));
    }
  }
}

TEST(ProtectedDrives, TellWhatEveryJointHasSent) {
  Drives arm = drives();
  for (std::size_t j = 0; j < kArmJoints; ++j) {
    const auto number = static_cast<float>(j + 1);
    EXPECT_EQ(arm.feedback(j, 0).encoder, SourceState::kNeverSeen);
    EXPECT_EQ(arm.feedback(j, 0).drive, SourceState::kNeverSeen);
    const Microseconds time_us = 100 * static_cast<Microseconds>(j);
    EXPECT_EQ(arm.take({reading_of(j, number, 7), time_us}), Status::kOk);
    EXPECT_EQ(arm.take({frame_with(MessageKind::kDriveStatus, j,
                                   DriveStatus{DriveMode::kTorque, kTorqueLimited, 10 * number}, 9),
                        time_us}),
              Status::kOk);
  }
  for (std::size_t j = 0; j < kArmJoints; ++j) {
    const auto number = static_cast<float>(j + 1);
    const JointFeedback joint = arm.feedback(j, 300);
    EXPECT_EQ(joint.encoder, SourceState::kValid);
    EXPECT_EQ(joint.drive, SourceState::kValid);
    EXPECT_EQ(joint.encoder_time_us, 100 * static_cast<Microseconds>(j));
    EXPECT_EQ(joint.reading.position, number);
    EXPECT_EQ(joint.reading.velocity, 0.5F);
    EXPECT_TRUE(joint.reading.has_velocity);
    EXPECT_EQ(joint.status.mode, DriveMode::kTorque);
    EXPECT_EQ(joint.status.flags, kTorqueLimited);
    EXPECT_EQ(joint.status.applied_torque, 10 * number);
    EXPECT_EQ(arm.encoder_source(j).accepted, 1U);
    EXPECT_EQ(arm.encoder_source(j).counter, 7);
    EXPECT_EQ(arm.drive_source(j).accepted, 1U);
    EXPECT_EQ(arm.drive_source(j).counter, 9);
  }
}

TEST(ProtectedDrives, JudgeEncodersAndDrivesByAgesOfTheirOwn) {
  Drives arm = drives();
  ASSERT_EQ(arm.take({reading_of(1, 0, 0), 0}), Status::kOk);
  ASSERT_EQ(arm.take({frame_with(MessageKind::kDriveStatus, 1, DriveStatus{}, 0), 0}), Status::kOk);
  EXPECT_EQ(arm.feedback(1, 2000).encoder, SourceState::kValid);
  EXPECT_EQ(arm.feedback(1, 2001).encoder, SourceState::kStale);
  EXPECT_EQ(arm.feedback(1, 5000).drive, SourceState::kValid);
  EXPECT_EQ(arm.feedback(1, 5001).drive, SourceState::kStale);
  EXPECT_EQ(arm.drive_max_age_us(), 5000);
}

TEST(ProtectedDrives, KeepTheNewestThatTheyHaveAccepted) {
  Drives arm = drives();
  ASSERT_EQ(arm.take({reading_of(0, 1, 10), 0}), Status::kOk);
  EXPECT_EQ(arm.take({reading_of(0, 2, 10), 1000}), Status::kRepeatedCounter);
  EXPECT_EQ(arm.take({reading_of(0, 3, 9), 1000}), Status::kSkippedCounter) << "an old one";
  EXPECT_EQ(arm.feedback(0, 1000).reading.position, 1.0F);
  EXPECT_EQ(arm.feedback(0, 1000).encoder, SourceState::kError);
}

TEST(ProtectedDrives, CountWhatDoesNotOpenAgainstItsSender) {
  Drives arm = drives();
  ASSERT_EQ(arm.take({reading_of(2, 1, 0), 0}), Status::kOk);
  Frame wrong = reading_of(2, 2, 1);
  wrong.data[0] ^= 1U;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(arm.take({wrong, 0}), Status::kWrongCrc);
  EXPECT_EQ(arm.feedback(2, 0).encoder, SourceState::kValid);
  EXPECT_EQ(arm.take({wrong, 0}), Status::kWrongCrc);
  EXPECT_EQ(arm.feedback(2, 0).encoder, SourceState::kError);
  EXPECT_EQ(arm.feedback(2, 0).reading.position, 1.0F);
  EXPECT_EQ(arm.encoder_source(2).rejected, 4U);
  EXPECT_EQ(arm.encoder_source(0).rejected, 0U);
}

// Zeros fill what a CAN FD frame is too long; a group for more joints than there are is no error.
TEST(ProtectedDrives, TakeEveryRecordOfAGroupAndLeaveWhatIsTooMuch) {
  for (const MessageKind kind : {MessageKind::kEncoder, MessageKind::kDriveStatus}) {
    Drives arm = drives(FrameFormat::kFd);
    std::vector<Record> records;
    for (std::size_t j = 0; j < 5; ++j) {
      records.push_back(kind == MessageKind::kEncoder
                            ? sealed(kind, j, EncoderReading{static_cast<float>(j)}, 0)
                            : sealed(kind, j, DriveStatus{DriveMode::kOff, 0, float(j)}, 0));
    }
    Frame frame;
    ASSERT_EQ(group_frame_of(kind, 0, records, frame), Status::kOk);
    EXPECT_EQ(arm.take({frame, 0}), Status::kOk);
    for (std::size_t j = 0; j < kArmJoints; ++j) {
      const JointFeedback joint = arm.feedback(j, 0);
      EXPECT_EQ(
          kind == MessageKind::kEncoder ? joint.reading.position : joint.status.applied_torque,
          static_cast<float>(j));
      EXPECT_EQ(kind == MessageKind::kEncoder ? joint.encoder : joint.drive, SourceState::kValid);
    }
  }
}

TEST(ProtectedDrives, OneBadRecordOfAGroupIsSaidAndTheOthersAreTaken) {
  for (std::size_t bad = 0; bad < kArmJoints; ++bad) {
    Drives arm = drives(FrameFormat::kFd);
    std::array<Record, kArmJoints> records;
    for (std::size_t j = 0; j < kArmJoints; ++j) {
      records[j] = sealed(MessageKind::kEncoder, j, EncoderReading{1}, 0);
    }
    records[bad][6] ^= 1U;
    Frame frame;
    ASSERT_EQ(group_frame_of(MessageKind::kEncoder, 0, records, frame), Status::kOk);
    EXPECT_EQ(arm.take({frame, 0}), Status::kWrongCrc) << bad;
    for (std::size_t j = 0; j < kArmJoints; ++j) {
      EXPECT_EQ(arm.encoder_source(j).accepted, j == bad ? 0U : 1U) << j;
    }
  }
}

TEST(ProtectedDrives, LeaveWhatIsNotForAController) {
  Drives arm = drives();
  Frame frame = reading_of(0, 1, 0);
  frame.id = 0x7FF;
  EXPECT_EQ(arm.take({frame, 0}), Status::kUnknownId);
  frame = reading_of(0, 1, 0);
  frame.remote = true;
  EXPECT_EQ(arm.take({frame, 0}), Status::kNotADataFrame);
  EXPECT_EQ(arm.take({frame_with(MessageKind::kTorqueCommand, 0, TorqueCommand{}, 0), 0}),
            Status::kUnknownId);
  EXPECT_EQ(arm.take({frame_with(MessageKind::kHeartbeat, 0, Heartbeat{}, 0), 0}),
            Status::kUnknownId);
  EXPECT_EQ(arm.take({frame_with(MessageKind::kDiagnosis, kControllerNode, Diagnosis{}, 0), 0}),
            Status::kUnknownId);
  EXPECT_EQ(arm.feedback(0, 0).encoder, SourceState::kNeverSeen);
  EXPECT_EQ(arm.encoder_source(0).rejected, 0U);
}

TEST(ProtectedDrives, LatchAnEmergencyStopOfAnyNodeUntilItIsCleared) {
  Drives arm = drives();
  EXPECT_FALSE(arm.stop_seen());
  Frame wrong = frame_with(MessageKind::kEmergencyStop, 30, EmergencyStop{30, 1}, 0);
  wrong.data[1] ^= 1U;
  EXPECT_EQ(arm.take({wrong, 0}), Status::kWrongCrc);
  EXPECT_FALSE(arm.stop_seen());
  const Frame stop = frame_with(MessageKind::kEmergencyStop, 30, EmergencyStop{30, 1}, 0);
  EXPECT_EQ(arm.take({stop, 0}), Status::kOk);
  EXPECT_TRUE(arm.stop_seen());
  EXPECT_EQ(arm.take({reading_of(0, 1, 0), 0}), Status::kOk);
  EXPECT_EQ(arm.take({wrong, 0}), Status::kWrongCrc);
  EXPECT_TRUE(arm.stop_seen()) << "latched";
  arm.clear_stop();
  EXPECT_FALSE(arm.stop_seen());
  EXPECT_EQ(arm.take({stop, 0}), Status::kOk);
  EXPECT_TRUE(arm.stop_seen()) << "the same frame again is a stop again";
}

TEST(ProtectedDrives, SendEveryJointItsCommandCountedOneByOne) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    Drives arm = drives(format);
    const std::array<TorqueCommand, kArmJoints> commands = {
        {{DriveMode::kTorque, 1.5F}, {DriveMode::kDamping, 0}, {DriveMode::kTorque, -3}}};
    std::array<Frame, Drives::kMaxOutgoing> frames;
    for (int tick = 0; tick < 600; ++tick) {
      const std::size_t count = arm.outgoing(commands, Heartbeat{.ticks = 1}, frames);
      ASSERT_EQ(count, format == FrameFormat::kFd ? 1U : kArmJoints);
      for (std::size_t j = 0; j < kArmJoints; ++j) {
        const Received found = received(std::span(frames).first(count), j);
        ASSERT_EQ(found.command.mode, commands[j].mode);
        ASSERT_EQ(found.command.torque, commands[j].torque);
        ASSERT_EQ(found.counter, static_cast<std::uint8_t>(tick));
      }
    }
  }
}

// GIVEN a torque that no frame can carry WHEN it is sent THEN its drive is told to be off, in
// sequence, and the others get theirs.
TEST(ProtectedDrives, SendOffWhereACommandCannotBeSent) {
  Drives arm = drives();
  std::array<Frame, Drives::kMaxOutgoing> frames;
  std::array<TorqueCommand, kArmJoints> commands;
  commands.fill({DriveMode::kTorque, 2.0F});
  static_cast<void>(arm.outgoing(commands, Heartbeat{.ticks = 1}, frames));
  for (const float torque :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    commands[1].torque = torque;
    const std::size_t count = arm.outgoing(commands, Heartbeat{.ticks = 1}, frames);
    ASSERT_EQ(count, kArmJoints);
    EXPECT_EQ(received(frames, 1).command.mode, DriveMode::kOff);
    EXPECT_EQ(received(frames, 1).command.torque, 0.0F);
    EXPECT_EQ(received(frames, 1).counter, received(frames, 0).counter);
    EXPECT_EQ(received(frames, 0).command.torque, 2.0F);
    EXPECT_EQ(received(frames, 2).command.torque, 2.0F);
  }
}

TEST(ProtectedDrives, ReportWhatTheMonitorFoundCountedOneByOne) {
  Drives arm = drives();
  for (int i = 0; i < 300; ++i) {
    Frame frame;
    ASSERT_FALSE(arm.report(Diagnosis{.worst_joint = 1, .error_to_threshold = -1}, frame));
    const Diagnosis sent{true, 3, 2, 1.5F};
    ASSERT_TRUE(arm.report(sent, frame));
    ASSERT_EQ(frame.id, 0x73FU);
    Diagnosis heard;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(record_in(frame, 0), data_id_of(MessageKind::kDiagnosis, kControllerNode),
                     heard, counter),
              Status::kOk);
    ASSERT_EQ(heard.first_joint, 3);
    ASSERT_EQ(counter, static_cast<std::uint8_t>(i)) << "what is not sent is not counted";
  }
}

TEST(ProtectedDrives, ReportWhichFaultItIsCountedByItself) {
  Drives arm = drives();
  Frame frame;
  ASSERT_TRUE(arm.report(Diagnosis{true, 3, 2, 1.5F}, frame));
  for (int i = 0; i < 3; ++i) {
    ASSERT_FALSE(arm.report(FaultReport{.joint = 0}, frame));
    ASSERT_TRUE(arm.report(FaultReport{1, 3, true, 0.99F, 2}, frame));
    ASSERT_EQ(frame.id, 0x75FU);
    FaultReport heard;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(record_in(frame, 0), data_id_of(MessageKind::kFault, kControllerNode), heard,
                     counter),
              Status::kOk);
    ASSERT_EQ(heard.joint, 3);
    ASSERT_EQ(counter, i);
  }
}

TEST(ProtectedDrives, SendAHeartbeatEveryTenthTick) {
  static_assert(Drives::kMaxOutgoing == kArmJoints + 1);
  Drives arm = drives();
  std::array<Frame, Drives::kMaxOutgoing> frames;
  const std::array<TorqueCommand, kArmJoints> commands{};
  std::uint8_t expected = 0;
  for (std::uint32_t tick = 0; tick < 3000; ++tick) {
    const Heartbeat sent{ControllerState::kFault, 7, tick};
    const std::size_t count = arm.outgoing(commands, sent, frames);
    ASSERT_EQ(count, tick % 10 == 0 ? kArmJoints + 1 : kArmJoints) << tick;
    if (count == kArmJoints) continue;
    const Frame& frame = frames[kArmJoints];
    ASSERT_EQ(frame.id, id_of(MessageKind::kHeartbeat, kControllerNode));
    Heartbeat heard;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(record_in(frame, 0), data_id_of(MessageKind::kHeartbeat, kControllerNode),
                     heard, counter),
              Status::kOk);
    ASSERT_EQ(heard.state, sent.state);
    ASSERT_EQ(heard.fault, sent.fault);
    ASSERT_EQ(heard.ticks, tick);
    ASSERT_EQ(counter, expected++);
  }
}

}  // namespace
}  // namespace offnominal::hal
