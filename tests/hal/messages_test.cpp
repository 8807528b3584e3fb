#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <random>

#include "support/seed.hpp"

namespace offnominal::hal {
namespace {

constexpr std::uint16_t kId = data_id_of(MessageKind::kEncoder, 0);
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <typename Message>
Message round_trip(const Message& sent, std::uint8_t counter = 5) {
  Record record{};
  EXPECT_EQ(encode(sent, counter, kId, record), Status::kOk);
  Message received;
  std::uint8_t received_counter = 0;
  EXPECT_EQ(decode(record, kId, received, received_counter), Status::kOk);
  EXPECT_EQ(received_counter, counter);
  return received;
}

template <typename Message>
Status encoded(const Message& message) {
  Record record{};
  return encode(message, 0, kId, record);
}

template <typename Message>
Status decoded(const Content& content) {
  Message message;
  std::uint8_t counter = 0;
  return decode(seal(content, 0, kId), kId, message, counter);
}

TEST(EncoderReading, ArrivesWithinHalfACount) {
  std::mt19937_64 random = test::seeded_generator();
  std::uniform_real_distribution<float> anywhere(-31.9F, 31.9F);
  for (int i = 0; i < 10000; ++i) {
    const EncoderReading sent{anywhere(random), anywhere(random), true};
    const EncoderReading received = round_trip(sent);
    EXPECT_LE(std::fabs(received.position - sent.position), 0.5F * kPositionPerCount);
    EXPECT_LE(std::fabs(received.velocity - sent.velocity), 0.5F * kVelocityPerCount);
    EXPECT_TRUE(received.has_velocity);
  }
}

TEST(EncoderReading, ReachesBothEndsOfItsRange) {
  const float end = 32.0F - kPositionPerCount;
  const float fastest = 32.0F - kVelocityPerCount;
  for (const float sign : {-1.0F, 1.0F}) {
    const EncoderReading received = round_trip(EncoderReading{sign * end, sign * fastest, true});
    EXPECT_EQ(received.position, sign * end);
    EXPECT_EQ(received.velocity, sign * fastest);
  }
}

TEST(EncoderReading, WithoutVelocitySaysSo) {
  const EncoderReading received = round_trip(EncoderReading{1.0F, 12.0F, false});
  EXPECT_FALSE(received.has_velocity);
  EXPECT_EQ(received.velocity, 0.0F);
}

TEST(EncoderReading, OutsideOfTheRangeIsRefused) {
  for (const float bad : {32.0F, -32.0F, kNan, kInfinity, -kInfinity, 1e30F}) {
    EXPECT_EQ(encoded(EncoderReading{bad, 0, true}), Status::kInvalidValue) << bad;
    EXPECT_EQ(encoded(EncoderReading{0, bad, true}), Status::kInvalidValue) << bad;
  }
  EXPECT_EQ(decoded<EncoderReading>({0, 0, 0x80, 0, 0}), Status::kInvalidValue);
}

TEST(TorqueCommand, ArrivesBitForBit) {
  for (const float torque : {0.0F, -0.1F, 1234.5F, std::numeric_limits<float>::denorm_min()}) {
    const TorqueCommand received = round_trip(TorqueCommand{DriveMode::kTorque, torque});
    EXPECT_EQ(received.mode, DriveMode::kTorque);
    EXPECT_EQ(received.torque, torque);
  }
}

TEST(TorqueCommand, ThatContradictsItselfIsRefused) {
  EXPECT_EQ(encoded(TorqueCommand{DriveMode::kOff, 1}), Status::kInvalidValue);
  EXPECT_EQ(encoded(TorqueCommand{DriveMode::kDamping, 1}), Status::kInvalidValue);
  EXPECT_EQ(encoded(TorqueCommand{DriveMode::kTorque, kNan}), Status::kInvalidValue);
  EXPECT_EQ(encoded(TorqueCommand{DriveMode::kTorque, kInfinity}), Status::kInvalidValue);
  EXPECT_EQ(decoded<TorqueCommand>({0, 0, 0x80, 0x3F, 0}), Status::kInvalidValue);  // 1 when off
  EXPECT_EQ(decoded<TorqueCommand>({0, 0, 0xC0, 0x7F, 2}), Status::kInvalidValue);  // NaN
  EXPECT_EQ(decoded<TorqueCommand>({0, 0, 0, 0, 3}), Status::kInvalidValue);        // no such mode
}

TEST(DriveStatus, ArrivesWithEveryFlag) {
  for (unsigned flags = 0; flags < 256; flags += 16) {
    const DriveStatus received =
        round_trip(DriveStatus{DriveMode::kDamping, static_cast<std::uint8_t>(flags), -3.5F});
    EXPECT_EQ(received.flags, flags);
    EXPECT_EQ(received.mode, DriveMode::kDamping);
    EXPECT_EQ(received.applied_torque, -3.5F);
  }
  EXPECT_EQ(encoded(DriveStatus{DriveMode::kOff, 1, 0}), Status::kInvalidValue);
  EXPECT_EQ(decoded<DriveStatus>({0, 0, 0, 0, 0x0F}), Status::kInvalidValue);
}

TEST(Heartbeat, Arrives) {
  const Heartbeat received = round_trip(Heartbeat{ControllerState::kFault, 107, 0xABCDEF});
  EXPECT_EQ(received.state, ControllerState::kFault);
  EXPECT_EQ(received.fault, 107);
  EXPECT_EQ(received.ticks, 0xABCDEFU);
  EXPECT_EQ(round_trip(Heartbeat{ControllerState::kInit, 0, 0x1000001}).ticks, 1U);
  EXPECT_EQ(decoded<Heartbeat>({4, 0, 0, 0, 0}), Status::kInvalidValue);
}

TEST(Diagnosis, ArrivesInItsCounts) {
  const Diagnosis received = round_trip(Diagnosis{true, 7, 12, 1.25F});
  EXPECT_TRUE(received.level);
  EXPECT_EQ(received.first_joint, 7);
  EXPECT_EQ(received.worst_joint, 12);
  EXPECT_EQ(received.error_to_threshold, 1.25F);
  EXPECT_FALSE(received.acts);
  EXPECT_TRUE(round_trip(Diagnosis{true, 7, 12, 1.25F, true}).acts);
  EXPECT_TRUE(round_trip(Diagnosis{false, 7, 0, 0, true}).acts) << "latched, as first_joint";
  const Diagnosis nothing = round_trip(Diagnosis{});
  EXPECT_FALSE(nothing.level);
  EXPECT_EQ(nothing.first_joint, 0);
  EXPECT_EQ(nothing.worst_joint, 0);
  for (const float large : {256.0F, 1e30F, kInfinity}) {
    EXPECT_EQ(round_trip(Diagnosis{true, 1, 1, large}).error_to_threshold, 255.99609375F) << large;
  }
}

TEST(Diagnosis, ThatContradictsItselfIsRefused) {
  EXPECT_EQ(encoded(Diagnosis{false, 0, 1, kNan}), Status::kInvalidValue);
  EXPECT_EQ(encoded(Diagnosis{false, 0, 1, -0.5F}), Status::kInvalidValue);
  EXPECT_EQ(encoded(Diagnosis{true, 1, 0, 0}), Status::kInvalidValue)
      << "beyond what nobody judges";
  EXPECT_EQ(encoded(Diagnosis{false, 1, 0, 0.5F}), Status::kInvalidValue);
  EXPECT_EQ(decoded<Diagnosis>({4, 0, 1, 0, 0}), Status::kInvalidValue);
  EXPECT_EQ(decoded<Diagnosis>({2, 0, 1, 0, 0}), Status::kInvalidValue) << "acts on no joint";
  EXPECT_EQ(encoded(Diagnosis{false, 0, 1, 0.5F, true}), Status::kInvalidValue);
  EXPECT_EQ(decoded<Diagnosis>({1, 1, 0, 0, 0}), Status::kInvalidValue);
  EXPECT_EQ(decoded<Diagnosis>({0, 1, 0, 1, 0}), Status::kInvalidValue);
  EXPECT_EQ(decoded<Diagnosis>({0, 1, 0, 0, 0}), Status::kOk);
}

TEST(FaultReport, ArrivesInItsCounts) {
  const FaultReport received = round_trip(FaultReport{4, 7, true, 1.0F, -2.5F});
  EXPECT_EQ(received.kind, 4);
  EXPECT_EQ(received.joint, 7);
  EXPECT_TRUE(received.decided);
  EXPECT_EQ(received.confidence, 1.0F);
  EXPECT_EQ(received.size, -2.5F);
  const FaultReport last = round_trip(FaultReport{15, 31, false, 0.5F, 0.0101F});
  EXPECT_EQ(last.kind, 15);
  EXPECT_EQ(last.joint, 31);
  EXPECT_FALSE(last.decided);
  EXPECT_NEAR(last.confidence, 0.5F, 0.51F / 63);
  EXPECT_NEAR(last.size, 0.0101F, 0.5F * kFaultSizePerCount);
  for (const float sign : {-1.0F, 1.0F}) {
    EXPECT_EQ(round_trip(FaultReport{1, 1, false, 0, sign * 1e30F}).size, sign * 4095.9995F);
  }
}

TEST(FaultReport, ThatSaysNothingIsRefused) {
  EXPECT_EQ(encoded(FaultReport{16, 1, true, 1, 0}), Status::kInvalidValue);
  EXPECT_EQ(encoded(FaultReport{1, 0, true, 1, 0}), Status::kInvalidValue);
  EXPECT_EQ(encoded(FaultReport{1, 32, true, 1, 0}), Status::kInvalidValue);
  for (const float share : {kNan, -0.01F, 1.01F}) {
    EXPECT_EQ(encoded(FaultReport{1, 1, true, share, 0}), Status::kInvalidValue) << share;
  }
  EXPECT_EQ(encoded(FaultReport{1, 1, true, 1, kInfinity}), Status::kInvalidValue);
  EXPECT_EQ(decoded<FaultReport>({0x01, 0, 0, 0, 0}), Status::kInvalidValue) << "no joint";
  EXPECT_EQ(decoded<FaultReport>({0x11, 0, 0, 0, 0x80}), Status::kInvalidValue) << "no size";
  EXPECT_EQ(decoded<FaultReport>({0x11, 0, 0, 0, 0}), Status::kOk);
}

TEST(EmergencyStop, Arrives) {
  const EmergencyStop received = round_trip(EmergencyStop{31, 42});
  EXPECT_EQ(received.source, 31);
  EXPECT_EQ(received.reason, 42);
  EXPECT_EQ(decoded<EmergencyStop>({0, 0, 1, 0, 0}), Status::kInvalidValue);
}

// GIVEN a record that does not open, THEN nothing of the message or the counter has changed.
TEST(Messages, KeepWhatTheyHadWhenARecordIsRefused) {
  Record record{};
  ASSERT_EQ(encode(EncoderReading{1, 2, true}, 3, kId, record), Status::kOk);
  record[0] ^= 1U;
  EncoderReading reading{9, 8, true};
  std::uint8_t counter = 77;
  EXPECT_EQ(decode(record, kId, reading, counter), Status::kWrongCrc);
  EXPECT_EQ(reading.position, 9);
  EXPECT_EQ(reading.velocity, 8);
  EXPECT_EQ(counter, 77);
}

// A joint that turns on and on: every position is carried, off by half a count and by whole tens of
// turns alone.
TEST(EncoderReading, CarriesAnyPositionModuloTenTurns) {
  for (double position = -500; position < 500; position += 0.37) {
    Record record{};
    ASSERT_EQ(encode(EncoderReading{carried_position(position), 0, true}, 0, 0, record),
              Status::kOk);
    EncoderReading reading;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(record, 0, reading, counter), Status::kOk);
    const double tens =
        (position - static_cast<double>(reading.position)) / (20 * std::numbers::pi);
    EXPECT_NEAR(tens, std::round(tens), 1e-6) << position;
    EXPECT_LE(std::fabs(reading.position), 31.42F);
  }
}

}  // namespace
}  // namespace offnominal::hal
