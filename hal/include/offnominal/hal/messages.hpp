#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <offnominal/hal/finite.hpp>
#include <offnominal/hal/record.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

// What the records mean. hal/offnominal.dbc says the same for other tools, and a test holds the two
// together. encode() refuses with kInvalidValue what the record cannot carry: a number that is not
// finite or outside of the range. decode() gives kWrongCrc, or kInvalidValue for content that no
// encode() makes; what it was to fill is then unchanged.

namespace offnominal::hal {

// Encoder -> controller. Positions are continuous over turns. 2^-18 rad or m per count: +-32, at
// 1.6 million counts a turn; 2^-10 rad/s or m/s per count of velocity: +-32.
struct EncoderReading {
  float position = 0;         // rad or m
  float velocity = 0;         // rad/s or m/s; 0 where has_velocity is false
  bool has_velocity = false;  // a drive that sends positions alone says no
};
inline constexpr float kPositionPerCount = 0x1p-18F;
inline constexpr float kVelocityPerCount = 0x1p-10F;

// A joint without position limits sends its position modulo ten turns, -5 to 5 of them: a whole
// number, so that who begins to listen at any time knows where in its turn the joint is. The
// controller counts the tens from there on, up to 1000 rad either way: 159 turns.
inline constexpr double kCarriedRangeRad = 20 * std::numbers::pi;
[[nodiscard]] inline float carried_position(double position_rad) {
  return static_cast<float>(std::remainder(position_rad, kCarriedRangeRad));
}

enum class DriveMode : std::uint8_t {
  kOff = 0,      // no torque
  kDamping = 1,  // against the motion, as the drive is configured
  kTorque = 2,   // the torque of the command
};

// Controller -> drive.
struct TorqueCommand {
  DriveMode mode = DriveMode::kOff;
  float torque = 0;  // N m or N, of the joint; 0 unless the mode is kTorque
};

// Bits of DriveStatus::flags; the upper half of a byte.
enum DriveFlag : std::uint8_t {
  kTorqueLimited = 0x10,   // the drive gives less than was asked for
  kEncoderFault = 0x20,    // its own encoder
  kDriveFault = 0x40,      // over-temperature, supply, short circuit
  kCommandMissing = 0x80,  // it has fallen back by itself, for want of valid commands
};

// Drive -> controller.
struct DriveStatus {
  DriveMode mode = DriveMode::kOff;  // really in
  std::uint8_t flags = 0;            // of DriveFlag
  float applied_torque = 0;          // N m or N, over the time since the last status
};

// States of a controller; docs/sil.md has the picture.
enum class ControllerState : std::uint8_t {
  kInit = 0,     // waits for every encoder and drive
  kPassive = 1,  // evaluates and reports, commands no torque
  kArmed = 2,    // commands torque
  kFault = 3,    // safe state, latched until it is re-armed
};

// Controller -> all.
struct Heartbeat {
  ControllerState state = ControllerState::kInit;
  std::uint8_t fault = 0;  // why it is in kFault: a number of offnominal::Status, hal::Status or
                           // controller::Fault; 0 otherwise
  // Since the start, modulo 2^32; modulo 2^24 on the wire, of which the former is a multiple.
  std::uint32_t ticks = 0;
};

// Controller -> all, of a monitor that judges joint by joint. Joints count from 1; 0: none.
struct Diagnosis {
  bool level = false;            // some joint is beyond its threshold
  std::uint8_t first_joint = 0;  // that crossed its threshold first since the run began, latched
  std::uint8_t worst_joint = 0;  // with the largest |e| / mu; none while nothing is judged
  // Its |e| / mu, >= 0; on the wire in 256ths, the largest number standing for all above it.
  float error_to_threshold = 0;
  bool acts = false;  // some joint has come beyond its second level too, latched
};
inline constexpr float kRatioPerCount = 0x1p-8F;

// Controller -> all, of a monitor that was asked which fault it is, from its first answer on.
struct FaultReport {
  std::uint8_t kind = 0;   // a number of offnominal::FaultKind, at most 15
  std::uint8_t joint = 1;  // from 1, at most 31; of a payload the last one
  bool decided = false;    // latched; before that the best answer so far
  float confidence = 0;    // 0 to 1, in 63rds on the wire
  // In the unit of its kind; on the wire in 2^-11 of it, the largest number of either sign standing
  // for all beyond it: +-4096.
  float size = 0;
};
inline constexpr float kFaultSizePerCount = 0x1p-11F;
inline constexpr unsigned kFaultConfidenceCounts = 63;

// Anyone -> all. Whoever sees one has to go to its safe state.
struct EmergencyStop {
  std::uint8_t source = 0;  // node that asks for it
  std::uint8_t reason = 0;  // as Heartbeat::fault
};

namespace detail {

// Nearest count; false where it needs more than `bits`, sign included, or is the lowest of them,
// which means "none".
[[nodiscard]] inline bool to_counts(float value, float per_count, int bits, std::int32_t& counts) {
  const auto limit = static_cast<float>((1 << (bits - 1)) - 1);
  const float scaled = value / per_count;
  if (!is_finite(scaled) || scaled < -limit || scaled > limit) return false;
  counts = static_cast<std::int32_t>(std::lrint(scaled));
  return true;
}

[[nodiscard]] constexpr std::int32_t sign_extended(std::uint32_t value, unsigned bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return static_cast<std::int32_t>((value ^ sign) - sign);
}

inline constexpr std::int32_t kNoPosition = -(1 << 23);
inline constexpr std::int32_t kNoVelocity = -(1 << 15);

inline constexpr std::uint8_t kMostFaultKind = 15;
inline constexpr std::uint8_t kMostFaultJoint = 31;

[[nodiscard]] constexpr bool is_mode(unsigned value) {
  return value <= static_cast<unsigned>(DriveMode::kTorque);
}

}  // namespace detail

[[nodiscard]] inline Status encode(const EncoderReading& reading, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  std::int32_t position = 0;
  std::int32_t velocity = detail::kNoVelocity;
  if (!detail::to_counts(reading.position, kPositionPerCount, 24, position)) {
    return Status::kInvalidValue;
  }
  if (reading.has_velocity &&
      !detail::to_counts(reading.velocity, kVelocityPerCount, 16, velocity)) {
    return Status::kInvalidValue;
  }
  Content content{};
  to_little_endian(static_cast<std::uint32_t>(position), std::span(content).first<3>());
  to_little_endian(static_cast<std::uint32_t>(velocity), std::span(content).last<2>());
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const TorqueCommand& command, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  const bool drives = command.mode == DriveMode::kTorque;
  if (!is_finite(command.torque) || (!drives && command.torque != 0)) {
    return Status::kInvalidValue;
  }
  Content content{};
  to_little_endian(std::bit_cast<std::uint32_t>(command.torque), std::span(content).first<4>());
  content[4] = static_cast<std::uint8_t>(command.mode);
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const DriveStatus& drive, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  if (!is_finite(drive.applied_torque) || (drive.flags & 0x0FU) != 0) {
    return Status::kInvalidValue;
  }
  Content content{};
  to_little_endian(std::bit_cast<std::uint32_t>(drive.applied_torque),
                   std::span(content).first<4>());
  content[4] = static_cast<std::uint8_t>(static_cast<unsigned>(drive.mode) | drive.flags);
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const Heartbeat& heartbeat, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  Content content{};
  content[0] = static_cast<std::uint8_t>(heartbeat.state);
  content[1] = heartbeat.fault;
  to_little_endian(heartbeat.ticks, std::span(content).last<3>());
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const Diagnosis& diagnosis, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  const float ratio = diagnosis.error_to_threshold;
  const bool judges = diagnosis.worst_joint != 0;
  // NaN is not.
  if (!(ratio >= 0) || (!judges && (diagnosis.level || ratio > 0))) return Status::kInvalidValue;
  if (diagnosis.acts && diagnosis.first_joint == 0) return Status::kInvalidValue;
  constexpr float kMost = 0xFFFF;
  const auto counts = static_cast<std::uint32_t>(std::fmin(ratio / kRatioPerCount, kMost));
  Content content{};
  content[0] = static_cast<std::uint8_t>((diagnosis.level ? 1U : 0U) | (diagnosis.acts ? 2U : 0U));
  content[1] = diagnosis.first_joint;
  content[2] = diagnosis.worst_joint;
  to_little_endian(counts, std::span(content).last<2>());
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const FaultReport& report, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  const bool is_share = report.confidence >= 0 && report.confidence <= 1;  // NaN is none
  const bool has_joint = report.joint >= 1 && report.joint <= detail::kMostFaultJoint;
  const bool fits = has_joint && report.kind <= detail::kMostFaultKind;
  if (!is_share || !fits || !is_finite(report.size)) return Status::kInvalidValue;
  constexpr auto kMost = static_cast<float>((1 << 23) - 1);
  const float counts = std::clamp(report.size / kFaultSizePerCount, -kMost, kMost);
  const auto confidence = static_cast<unsigned>(
      std::lrint(report.confidence * static_cast<float>(kFaultConfidenceCounts)));
  const unsigned what = unsigned{report.kind} | unsigned{report.joint} << 4U |
                        (report.decided ? 1U : 0U) << 9U | confidence << 10U;
  Content content{};
  to_little_endian(what, std::span(content).first<2>());
  to_little_endian(static_cast<std::uint32_t>(std::lrint(counts)), std::span(content).last<3>());
  record = seal(content, counter, data_id);
  return Status::kOk;
}

[[nodiscard]] inline Status encode(const EmergencyStop& stop, std::uint8_t counter,
                                   std::uint16_t data_id, Record& record) {
  record = seal({stop.source, stop.reason, 0, 0, 0}, counter, data_id);
  return Status::kOk;
}

namespace detail {

// Whether some encode() makes such content; what it says, then.
[[nodiscard]] inline bool from_content(const Content& content, EncoderReading& reading) {
  const std::int32_t position =
      sign_extended(from_little_endian(std::span(content).first<3>()), 24);
  const std::int32_t velocity = sign_extended(from_little_endian(std::span(content).last<2>()), 16);
  if (position == kNoPosition) return false;
  reading.position = static_cast<float>(position) * kPositionPerCount;
  reading.has_velocity = velocity != kNoVelocity;
  reading.velocity = reading.has_velocity ? static_cast<float>(velocity) * kVelocityPerCount : 0.0F;
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, TorqueCommand& command) {
  const auto torque = std::bit_cast<float>(from_little_endian(std::span(content).first<4>()));
  if (!is_mode(content[4]) || !is_finite(torque)) return false;
  const auto mode = static_cast<DriveMode>(content[4]);
  if (mode != DriveMode::kTorque && torque != 0) return false;
  command = {mode, torque};
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, DriveStatus& drive) {
  const auto torque = std::bit_cast<float>(from_little_endian(std::span(content).first<4>()));
  const unsigned mode = content[4] & 0x0FU;
  if (!is_mode(mode) || !is_finite(torque)) return false;
  drive = {static_cast<DriveMode>(mode), static_cast<std::uint8_t>(content[4] & 0xF0U), torque};
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, Heartbeat& heartbeat) {
  if (content[0] > static_cast<unsigned>(ControllerState::kFault)) return false;
  heartbeat = {static_cast<ControllerState>(content[0]), content[1],
               from_little_endian(std::span(content).last<3>())};
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, Diagnosis& diagnosis) {
  const std::uint32_t counts = from_little_endian(std::span(content).last<2>());
  const bool judges = content[2] != 0;
  const bool level = (content[0] & 1U) != 0;
  const bool acts = (content[0] & 2U) != 0;
  if (content[0] > 3 || (!judges && (level || counts != 0))) return false;
  if (acts && content[1] == 0) return false;
  diagnosis = {level, content[1], content[2], static_cast<float>(counts) * kRatioPerCount, acts};
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, FaultReport& report) {
  const std::uint32_t what = from_little_endian(std::span(content).first<2>());
  const std::int32_t size = sign_extended(from_little_endian(std::span(content).last<3>()), 24);
  const auto kind = static_cast<std::uint8_t>(what & kMostFaultKind);
  const auto joint = static_cast<std::uint8_t>(what >> 4U & kMostFaultJoint);
  if (joint == 0 || size == -(1 << 23)) return false;
  report = {kind, joint, (what >> 9U & 1U) != 0,
            static_cast<float>(what >> 10U) / static_cast<float>(kFaultConfidenceCounts),
            static_cast<float>(size) * kFaultSizePerCount};
  return true;
}

[[nodiscard]] inline bool from_content(const Content& content, EmergencyStop& stop) {
  if (content[2] != 0 || content[3] != 0 || content[4] != 0) return false;
  stop = {content[0], content[1]};
  return true;
}

}  // namespace detail

// Message: one of the structures above.
template <typename Message>
[[nodiscard]] Status decode(std::span<const std::uint8_t, kRecordLength> record,
                            std::uint16_t data_id, Message& message, std::uint8_t& counter) {
  Content content{};
  std::uint8_t count = 0;
  if (const Status status = open(record, data_id, content, count); status != Status::kOk) {
    return status;
  }
  if (!detail::from_content(content, message)) return Status::kInvalidValue;
  counter = count;
  return Status::kOk;
}

}  // namespace offnominal::hal
