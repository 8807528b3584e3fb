#include "log/dbc.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <set>

#include "common/error.hpp"
#include "support/recordings.hpp"

namespace offnominal::desk {
namespace {

using Values = std::map<std::string, double>;

// The signals of a frame by the DBC file, names without the group's prefix for the given joint.
Values signals_of(const hal::Frame& frame, const std::string& prefix = {}) {
  const DbcMessage* message = offnominal_dbc().find(frame.id, false);
  Values values;
  if (message == nullptr) return values;
  for (const DbcSignal& signal : message->signals) {
    if (!signal.name.starts_with(prefix)) continue;
    EXPECT_TRUE(signal.fits(frame.length)) << signal.name;
    values[signal.name.substr(prefix.size())] =
        signal.value_in(std::span<const std::uint8_t>(frame.data).first(frame.length));
  }
  return values;
}

template <typename Message>
hal::Record record_of(hal::MessageKind kind, std::uint8_t node, const Message& message) {
  hal::Record record{};
  EXPECT_EQ(encode(message, 200, data_id_of(kind, node), record), hal::Status::kOk);
  return record;
}

// The classic frame, and the CAN FD group's record where the kind has groups.
template <typename Message, typename Expect>
void expect_both(hal::MessageKind kind, const Message& message, Expect&& expect, bool groups) {
  for (std::uint8_t node = 0; node < 8; ++node) {
    const hal::Record record = record_of(kind, node, message);
    const Values classic = signals_of(frame_of(kind, node, record));
    ASSERT_FALSE(classic.empty()) << "joint " << node + 1 << " is not in the DBC file";
    EXPECT_EQ(classic.at("counter"), 200);
    EXPECT_EQ(classic.at("crc"), 256 * record[6] + record[7]);
    expect(classic);
    if (!groups) continue;
    std::array<hal::Record, 8> records{};
    records[node] = record;
    hal::Frame frame;
    ASSERT_EQ(group_frame_of(kind, 0, records, frame), hal::Status::kOk);
    expect(signals_of(frame, "j" + std::to_string(node + 1) + "_"));
  }
}

TEST(Dbc, SaysOfReadingsWhatTheCodeSays) {
  const hal::EncoderReading reading{-1.25F, 3.5F, true};
  expect_both(
      hal::MessageKind::kEncoder, reading,
      [](const Values& values) {
        EXPECT_EQ(values.at("position"), -1.25);
        EXPECT_EQ(values.at("velocity"), 3.5);
      },
      true);
}

TEST(Dbc, SaysOfTorqueCommandsWhatTheCodeSays) {
  expect_both(
      hal::MessageKind::kTorqueCommand, hal::TorqueCommand{hal::DriveMode::kTorque, -12.75F},
      [](const Values& values) {
        EXPECT_EQ(values.at("torque"), -12.75);
        EXPECT_EQ(values.at("mode"), 2);
      },
      true);
}

TEST(Dbc, SaysOfStatusesWhatTheCodeSays) {
  for (const auto flag :
       {hal::kTorqueLimited, hal::kEncoderFault, hal::kDriveFault, hal::kCommandMissing}) {
    expect_both(
        hal::MessageKind::kDriveStatus, hal::DriveStatus{hal::DriveMode::kDamping, flag, 0.5F},
        [flag](const Values& values) {
          EXPECT_EQ(values.at("applied_torque"), 0.5);
          EXPECT_EQ(values.at("mode"), 1);
          EXPECT_EQ(values.at("torque_limited"), flag == hal::kTorqueLimited);
          EXPECT_EQ(values.at("encoder_fault"), flag == hal::kEncoderFault);
          EXPECT_EQ(values.at("drive_fault"), flag == hal::kDriveFault);
          EXPECT_EQ(values.at("command_missing"), flag == hal::kCommandMissing);
        },
        true);
  }
}

TEST(Dbc, SaysOfHeartbeatsAndStopsWhatTheCodeSays) {
  const Values beat =
      signals_of(frame_of(hal::MessageKind::kHeartbeat, 31,
                          record_of(hal::MessageKind::kHeartbeat, 31,
                                    hal::Heartbeat{hal::ControllerState::kFault, 160, 0xABCDEF})));
  ASSERT_FALSE(beat.empty());
  EXPECT_EQ(beat.at("state"), 3);
  EXPECT_EQ(beat.at("fault"), 160);
  EXPECT_EQ(beat.at("ticks"), 0xABCDEF);
  expect_both(
      hal::MessageKind::kEmergencyStop, hal::EmergencyStop{5, 165},
      [](const Values& values) {
        EXPECT_EQ(values.at("source"), 5);
        EXPECT_EQ(values.at("reason"), 165);
      },
      false);
}

TEST(Dbc, SaysOfDiagnosesWhatTheCodeSays) {
  const Values found = signals_of(frame_of(
      hal::MessageKind::kDiagnosis, 31,
      record_of(hal::MessageKind::kDiagnosis, 31, hal::Diagnosis{true, 4, 6, 100.25F, true})));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.at("beyond_threshold"), 1);
  EXPECT_EQ(found.at("acts"), 1);
  EXPECT_EQ(found.at("first_joint"), 4);
  EXPECT_EQ(found.at("worst_joint"), 6);
  EXPECT_EQ(found.at("error_to_threshold"), 100.25);
}

TEST(Dbc, SaysOfFaultsWhatTheCodeSays) {
  const Values found = signals_of(frame_of(
      hal::MessageKind::kFault, 31,
      record_of(hal::MessageKind::kFault, 31, hal::FaultReport{8, 29, true, 1.0F, -1234.5F})));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.at("kind"), 8);
  EXPECT_EQ(found.at("joint"), 29);
  EXPECT_EQ(found.at("decided"), 1);
  EXPECT_NEAR(found.at("confidence"), 1, 1e-12);
  EXPECT_EQ(found.at("size"), -1234.5);
}

// No message beside those of the code, and every bit of a record has a signal, one alone.
TEST(Dbc, CoversEveryBitOfEveryFrameOnce) {
  std::set<std::uint32_t> ids;
  for (const DbcMessage& message : offnominal_dbc().messages) {
    EXPECT_TRUE(ids.insert(message.id).second) << message.name;
    hal::Frame frame;
    frame.id = message.id;
    frame.length = static_cast<std::uint8_t>(message.length);
    frame.fd = message.length > 8;
    hal::Address address;
    EXPECT_EQ(address_of(frame, address), hal::Status::kOk) << message.name;
    std::vector<int> covered(static_cast<std::size_t>(8 * message.length));
    for (const DbcSignal& signal : message.signals) {
      for (std::size_t bit = 0; bit < covered.size(); ++bit) {
        hal::Frame one = frame;
        one.data[bit / 8] = static_cast<std::uint8_t>(1U << (bit % 8));
        DbcSignal plain = signal;
        plain.is_float = false;
        plain.offset = 0;
        const auto bytes = std::span<const std::uint8_t>(one.data).first(one.length);
        if (plain.value_in(bytes) != 0) ++covered[bit];
      }
    }
    EXPECT_THAT(covered, testing::Each(1)) << message.name;
  }
}

TEST(Dbc, ReadsTheFileOfARealDrive) {
  const std::filesystem::path file = test::recordings_dir() / "can_odrive_dbc/odrive-cansimple.dbc";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "SKIP_ no " << file;
  const Dbc dbc = read_dbc(file);
  const DbcMessage* estimates = dbc.find(9, false);
  ASSERT_NE(estimates, nullptr);
  EXPECT_EQ(estimates->name, "Axis0_Get_Encoder_Estimates");
  const std::array<std::uint8_t, 8> bytes = {0, 0, 0x80, 0x3F, 0, 0, 0x20, 0xC0};
  for (const DbcSignal& signal : estimates->signals) {
    EXPECT_EQ(signal.value_in(bytes), signal.name == "Pos_Estimate" ? 1.0 : -2.5);
  }
}

TEST(Dbc, RefusesWhatItCannotRead) {
  const auto refused = [](const std::string& text) {
    try {
      static_cast<void>(parse_dbc(text, "x.dbc"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused("\nBO_ x y: 8 z\n"), HasSubstr("line 2"));
  EXPECT_THAT(refused(" SG_ a : 0|8@1+ (1,0) [0|1] \"\" X\n"), HasSubstr("no message"));
  EXPECT_THAT(refused("BO_ 1 m: 1 z\n SG_ a : 4|8@1+ (1,0) [0|1] \"\" X\n"),
              HasSubstr("beyond the end"));
  EXPECT_THAT(refused("BO_ 1 m: 8 z\n SG_ a : 7|9@0+ (1,0) [0|1] X\n"), HasSubstr("line 2"));
  EXPECT_THAT(refused("BO_ 1 m: 8 z\n SG_ a : 0|8@1+ (1x,0) [0|1] \"\" X\n"), HasSubstr("1x"));
  EXPECT_THAT(refused("BO_ 1 m: 80 z\n"), HasSubstr("64"));
}

}  // namespace
}  // namespace offnominal::desk
