#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/record.hpp>
#include <span>

// ODrive's CANSimple protocol, as far as a torque controller needs it: heartbeat with axis error,
// encoder estimates, input torque, axis state (ODrive documentation, "CAN Protocol", firmware 0.5;
// tools/odrive-cansimple.dbc). Its frames carry neither counter nor CRC: a repeated or forged one
// is not seen, a source is judged by its age alone.

namespace offnominal::hal {

// One axis and the joint behind its gear.
struct CanSimpleAxis {
  std::uint8_t node = 0;  // axis node id, 0 to 63
  // Joint radians (or metres) per turn of the motor; negative where they turn against each other.
  float joint_per_turn = 2 * std::numbers::pi_v<float>;
};

struct CanSimpleConfig {
  Microseconds encoder_max_age_us = 3000;  // of "Get encoder estimates", sent cyclically
  Microseconds drive_max_age_us = 250000;  // of heartbeats, of which there are ten a second
};

template <std::size_t Joints>
class CanSimpleDrives {
 public:
  static_assert(Joints >= 1);
  static constexpr std::size_t kJoints = Joints;
  static constexpr std::size_t kMaxOutgoing = 2 * Joints;

  // The axes have to be configured for torque control (input mode "passthrough") before.
  CanSimpleDrives(const CanSimpleConfig& config, const std::array<CanSimpleAxis, Joints>& axes)
      : config_(config), axes_(axes) {}

  [[nodiscard]] Status take(const ReceivedFrame& received) {
    const Frame& frame = received.frame;
    const std::uint32_t command = frame.id & kCommandMask;
    const bool known = command == kHeartbeatCommand || command == kEncoderCommand;
    if (frame.extended || frame.fd || !known) return Status::kUnknownId;
    for (std::size_t j = 0; j < Joints; ++j) {
      if (axes_[j].node != frame.id >> kCommandBits) continue;
      if (frame.remote) return Status::kNotADataFrame;
      if (frame.length != kMaxClassicLength) return Status::kWrongLength;
      const auto data = std::span<const std::uint8_t>(frame.data).first<kMaxClassicLength>();
      return command == kHeartbeatCommand ? take_heartbeat(j, data, received.time_us)
                                          : take_encoder(j, data, received.time_us);
    }
    return Status::kUnknownId;
  }

  // The status' applied torque is what was commanded last, while the axis is in closed loop: the
  // protocol does not tell what a drive really gives.
  [[nodiscard]] JointFeedback feedback(std::size_t joint, Microseconds now_us) const {
    const Axis& axis = state_[joint];
    return {state_at(axis.encoder, config_.encoder_max_age_us, now_us),
            state_at(axis.heartbeat, config_.drive_max_age_us, now_us), axis.encoder.time_us,
            axis.reading, axis.status};
  }

  // Torque for axes in closed loop; others are asked into it first. kOff, and kDamping, which the
  // protocol does not have, ask for idle, again with every heartbeat.
  [[nodiscard]] std::size_t outgoing(std::span<const TorqueCommand> commands,
                                     const Heartbeat& heartbeat, std::span<Frame> into) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < Joints; ++j) {
      Axis& axis = state_[j];
      const TorqueCommand& command = commands[j];
      const bool drives = command.mode == DriveMode::kTorque && std::isfinite(command.torque);
      const bool changed = drives != axis.told_to_drive;
      axis.told_to_drive = drives;
      const bool follows = (axis.status.mode == DriveMode::kTorque) == drives;
      if (changed || !follows || heartbeat.ticks % kHeartbeatTicks == 0) {
        into[count++] = word_frame(j, kStateCommand, drives ? kClosedLoop : kIdle);
      }
      const float torque = drives ? command.torque : 0.0F;
      axis.status.applied_torque = axis.status.mode == DriveMode::kTorque ? torque : 0.0F;
      if (!drives) continue;
      // Power is the same on both sides of the gear.
      const float per_turn = axes_[j].joint_per_turn / (2 * std::numbers::pi_v<float>);
      into[count++] =
          word_frame(j, kTorqueCommand, std::bit_cast<std::uint32_t>(torque * per_turn));
    }
    return count;
  }

  // Nobody asks for an emergency stop in this protocol; an axis that stopped says so by its error.
  [[nodiscard]] bool stop_seen() const { return false; }
  void clear_stop() {}

 private:
  static constexpr std::uint32_t kCommandBits = 5;
  static constexpr std::uint32_t kCommandMask = 0x1F;
  static constexpr std::uint32_t kHeartbeatCommand = 0x01;
  static constexpr std::uint32_t kStateCommand = 0x07;
  static constexpr std::uint32_t kEncoderCommand = 0x09;
  static constexpr std::uint32_t kTorqueCommand = 0x0E;
  static constexpr std::uint32_t kIdle = 1;
  static constexpr std::uint32_t kClosedLoop = 8;

  struct Age {
    bool seen = false;
    Microseconds time_us = 0;
  };
  struct Axis {
    Age encoder;
    Age heartbeat;
    EncoderReading reading;
    DriveStatus status;
    bool told_to_drive = false;
  };

  static SourceState state_at(const Age& age, Microseconds max_age_us, Microseconds now_us) {
    if (!age.seen) return SourceState::kNeverSeen;
    return now_us - age.time_us > max_age_us ? SourceState::kStale : SourceState::kValid;
  }

  Status take_heartbeat(std::size_t joint, std::span<const std::uint8_t, 8> data,
                        Microseconds time_us) {
    Axis& axis = state_[joint];
    const bool encoder_failed = (data[6] & 1U) != 0;
    const bool failed =
        from_little_endian(data.first<4>()) != 0 || (data[5] & 1U) != 0 || (data[7] & 1U) != 0;
    axis.status.mode = data[4] == kClosedLoop ? DriveMode::kTorque : DriveMode::kOff;
    axis.status.flags = static_cast<std::uint8_t>((encoder_failed ? kEncoderFault : 0) |
                                                  (failed ? kDriveFault : 0));
    axis.heartbeat = {true, time_us};
    return Status::kOk;
  }

  Status take_encoder(std::size_t joint, std::span<const std::uint8_t, 8> data,
                      Microseconds time_us) {
    const float per_turn = axes_[joint].joint_per_turn;
    const auto turns = std::bit_cast<float>(from_little_endian(data.first<4>()));
    const auto turns_per_s = std::bit_cast<float>(from_little_endian(data.last<4>()));
    const EncoderReading reading{turns * per_turn, turns_per_s * per_turn, true};
    if (!std::isfinite(reading.position) || !std::isfinite(reading.velocity)) {
      return Status::kInvalidValue;
    }
    state_[joint].reading = reading;
    state_[joint].encoder = {true, time_us};
    return Status::kOk;
  }

  [[nodiscard]] Frame word_frame(std::size_t joint, std::uint32_t command,
                                 std::uint32_t word) const {
    Frame frame;
    frame.id = (static_cast<std::uint32_t>(axes_[joint].node) << kCommandBits) | command;
    frame.length = kMaxClassicLength;
    to_little_endian(word, std::span<std::uint8_t>(frame.data).first(4));
    return frame;
  }

  CanSimpleConfig config_;
  std::array<CanSimpleAxis, Joints> axes_;
  std::array<Axis, Joints> state_{};
};

static_assert(DriveProtocol<CanSimpleDrives<2>>);

}  // namespace offnominal::hal
