#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <offnominal/hal/bus/wire_time.hpp>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/finite.hpp>
#include <offnominal/hal/record.hpp>
#include <offnominal/joint_count.hpp>
#include <span>

// ODrive's CANSimple protocol, as far as a torque controller needs it (docs/can-simple.md): ODrive
// documentation, "CAN Protocol", firmware 0.5 (tools/odrive-cansimple.dbc) and 0.6. Its frames
// carry neither counter nor CRC: a repeated or forged one is not seen, a source is judged by its
// age alone.

namespace offnominal::hal {

// They differ in the heartbeat's last three bytes and in the message that tells the torque.
enum class CanSimpleFirmware : std::uint8_t { k05, k06 };

// One axis and the joint behind its gear.
struct CanSimpleAxis {
  std::uint8_t node = 0;  // axis node id, 0 to 63
  // Joint radians (or metres) per turn of the motor; negative where they turn against each other.
  float joint_per_turn = 2 * std::numbers::pi_v<float>;
  CanSimpleFirmware firmware = CanSimpleFirmware::k06;
  // Firmware 0.5, where it tells its current: the motor's torque_constant, negative where its
  // direction is -1.
  float motor_nm_per_ampere = 0;
};

// Intervals of the cyclic messages, as the axes are configured (axis.config.can). A source is stale
// when the third message in a row is missing.
struct CanSimpleConfig {
  Microseconds encoder_interval_us = 1000;      // "Get encoder estimates"
  Microseconds heartbeat_interval_us = 100000;  // "Heartbeat": axis state and errors
  // Firmware 0.6 "Get torques", 0.5 "Get Iq". 0: not sent, the torque that was commanded is taken
  // for the one applied while the axis is in closed loop.
  Microseconds torque_interval_us = 0;
};

inline constexpr std::uint8_t kCanSimpleNodes = 64;  // 6 bits of an identifier

// kOk where every axis can be told from the others and the numbers are ones. kInvalidNode: 64 or
// more, or two axes with the same. kInvalidScale: joint_per_turn is 0, or it or motor_nm_per_ampere
// is not finite. kInvalidInterval: not above 0, or the torque's below.
[[nodiscard]] inline Status validate(const CanSimpleConfig& config,
                                     std::span<const CanSimpleAxis> axes) {
  if (config.encoder_interval_us <= 0 || config.heartbeat_interval_us <= 0 ||
      config.torque_interval_us < 0) {
    return Status::kInvalidInterval;
  }
  std::uint64_t taken = 0;
  for (const CanSimpleAxis& axis : axes) {
    if (axis.node >= kCanSimpleNodes || (taken >> axis.node & 1U) != 0) return Status::kInvalidNode;
    taken |= std::uint64_t{1} << axis.node;
    const bool scaled = is_finite(axis.joint_per_turn) && axis.joint_per_turn != 0 &&
                        is_finite(axis.motor_nm_per_ampere);
    if (!scaled) return Status::kInvalidScale;
  }
  return Status::kOk;
}

// Joints: a number, or kAnyJoints for as many as there are axes.
template <std::size_t Joints>
class CanSimpleDrives {
 public:
  static_assert(Joints >= 1);
  static constexpr std::size_t kJoints = Joints;
  static constexpr std::size_t kMaxOutgoing = 2 * kMostDrives<Joints>;
  using Axes = PerJoint<static_cast<int>(Joints), CanSimpleAxis>;

  // The axes have to be configured for torque control (input mode "passthrough") before. With a
  // configuration that validate() refuses it hears nobody and tells nobody anything.
  CanSimpleDrives(const CanSimpleConfig& config, const Axes& axes)
      : config_(config),
        axes_(axes),
        configuration_(validate(config, axes)),
        state_(per_joint<Joints, Axis>(axes.size())) {}

  // What validate() says of the configuration; to be looked at before the first tick.
  [[nodiscard]] Status configuration() const { return configuration_; }

  [[nodiscard]] Status take(const ReceivedFrame& received) {
    if (configuration_ != Status::kOk) return configuration_;
    const Frame& frame = received.frame;
    if (frame.extended || frame.fd) return Status::kUnknownId;
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      if (axes_[j].node == frame.id >> kCommandBits) return take_of(j, frame, received.time_us);
    }
    return Status::kUnknownId;
  }

  // Where axes send no torque: the one that they are told, which is taken for the one applied, and
  // the state that they are asked for. Until the next heartbeat nobody knows which is in.
  [[nodiscard]] Status overhear(const ReceivedFrame& received) {
    if (configuration_ != Status::kOk) return configuration_;
    const Frame& frame = received.frame;
    const std::uint32_t command = frame.id & kCommandMask;
    const bool tells = command == kTorqueCommand || command == kStateCommand;
    if (frame.extended || frame.fd || frame.remote || !tells || config_.torque_interval_us > 0) {
      return Status::kUnknownId;
    }
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      if (axes_[j].node != frame.id >> kCommandBits) continue;
      if (frame.length != kMaxClassicLength) return Status::kWrongLength;
      const Data data = std::span<const std::uint8_t>(frame.data).first<kMaxClassicLength>();
      return overhear_of(j, command, data, received.time_us);
    }
    return Status::kUnknownId;
  }

  // The status' mode is kTorque where a heartbeat says closed loop that came kStateTimeUs or more
  // after this axis was last asked for it: an older one may be about what was before.
  [[nodiscard]] JointFeedback feedback(std::size_t joint, Microseconds now_us) const {
    const Axis& axis = state_[joint];
    DriveStatus status{axis.mode, axis.flags, 0};
    SourceState drive = state_at(axis.heartbeat, config_.heartbeat_interval_us, now_us);
    if (config_.torque_interval_us > 0) {
      status.applied_torque = axis.reported_torque;
      const SourceState torque = state_at(axis.torque, config_.torque_interval_us, now_us);
      if (drive == SourceState::kValid) drive = torque;
    } else if (axis.mode == DriveMode::kTorque) {
      status.applied_torque = axis.commanded_torque;
    }
    return {state_at(axis.encoder, config_.encoder_interval_us, now_us), drive,
            axis.encoder.time_us, axis.reading, status};
  }

  // Torque in every tick, and closed loop asked for once: asking an axis that is in it makes it
  // leave and enter again, without torque meanwhile. Asked for again where a heartbeat says that it
  // is not in closed loop. kOff, and kDamping, which the protocol does not have, ask for idle and
  // no torque, until a heartbeat says so and with every heartbeat of the controller.
  [[nodiscard]] std::size_t outgoing(std::span<const TorqueCommand> commands,
                                     const Heartbeat& heartbeat, std::span<Frame> into) {
    if (configuration_ != Status::kOk) return 0;
    std::size_t count = 0;
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      Axis& axis = state_[j];
      const TorqueCommand& command = commands[j];
      const bool drives = command.mode == DriveMode::kTorque && is_finite(command.torque);
      const bool asks = drives ? !axis.told_to_drive || axis.refused
                               : axis.told_to_drive || axis.mode == DriveMode::kTorque ||
                                     heartbeat.ticks % kHeartbeatTicks == 0;
      axis.told_to_drive = drives;
      axis.commanded_torque = drives ? command.torque : 0.0F;
      // The torque first: no axis enters closed loop with one of before.
      if (drives || asks) into[count++] = torque_frame(j, axis.commanded_torque);
      if (!asks) continue;
      into[count++] = word_frame(j, kStateCommand, drives ? kClosedLoop : kIdle);
      axis.refused = false;
      if (!drives) continue;
      axis.mode = DriveMode::kOff;
      axis.asked_us = newest_us_;
    }
    return count;
  }

  [[nodiscard]] Microseconds drive_max_age_us() const {
    return max_age_us(config_.heartbeat_interval_us);
  }

  // The protocol has no frame for it.
  [[nodiscard]] static bool report(const Diagnosis& /*found*/, Frame& /*into*/) { return false; }
  [[nodiscard]] static bool report(const FaultReport& /*fault*/, Frame& /*into*/) { return false; }

  // Nobody asks for an emergency stop in this protocol; an axis that stopped says so by its error.
  [[nodiscard]] bool stop_seen() const { return false; }
  void clear_stop() {}
  [[nodiscard]] DriveCounts counts() const { return {}; }

  // From being asked for a state until an axis is in it, and its heartbeat has gone out.
  static constexpr Microseconds kStateTimeUs = 15000;

 private:
  static constexpr std::uint32_t kCommandBits = 5;
  static constexpr std::uint32_t kCommandMask = 0x1F;
  static constexpr std::uint32_t kHeartbeatCommand = 0x01;
  static constexpr std::uint32_t kStateCommand = 0x07;
  static constexpr std::uint32_t kEncoderCommand = 0x09;
  static constexpr std::uint32_t kTorqueCommand = 0x0E;
  static constexpr std::uint32_t kCurrentsCommand = 0x14;  // "Get Iq"
  static constexpr std::uint32_t kTorquesCommand = 0x1C;   // firmware 0.5: "Get ADC voltage"
  static constexpr std::uint32_t kIdle = 1;
  static constexpr std::uint32_t kClosedLoop = 8;

  using Data = std::span<const std::uint8_t, kMaxClassicLength>;

  struct Age {
    bool seen = false;
    Microseconds time_us = 0;
  };
  struct Axis {
    Age encoder;
    Age heartbeat;
    Age torque;
    EncoderReading reading;
    DriveMode mode = DriveMode::kOff;
    std::uint8_t flags = 0;
    float reported_torque = 0;   // of the joint
    float commanded_torque = 0;  // of the joint
    bool told_to_drive = false;
    bool refused = false;  // it has been asked for closed loop, and a heartbeat says that it is not
    Microseconds asked_us = 0;  // for closed loop
  };

  static constexpr Microseconds max_age_us(Microseconds interval_us) { return interval_us * 5 / 2; }
  static SourceState state_at(const Age& age, Microseconds interval_us, Microseconds now_us) {
    if (!age.seen) return SourceState::kNeverSeen;
    const Microseconds age_us = now_us - age.time_us;
    // A time of the future says nothing of now: silent or not, it would be valid until then.
    const bool believed = age_us <= max_age_us(interval_us) && age_us >= -max_age_us(interval_us);
    return believed ? SourceState::kValid : SourceState::kStale;
  }

  // Power is the same on both sides of the gear.
  [[nodiscard]] float motor_torque_per_joint_torque(std::size_t joint) const {
    return axes_[joint].joint_per_turn / (2 * std::numbers::pi_v<float>);
  }

  Status take_of(std::size_t joint, const Frame& frame, Microseconds time_us) {
    const std::uint32_t command = frame.id & kCommandMask;
    const bool old = axes_[joint].firmware == CanSimpleFirmware::k05;
    const bool tells_torque =
        config_.torque_interval_us > 0 &&
        (old ? command == kCurrentsCommand && axes_[joint].motor_nm_per_ampere != 0
             : command == kTorquesCommand);
    const bool known = command == kHeartbeatCommand || command == kEncoderCommand || tells_torque;
    if (!known) return Status::kUnknownId;
    if (frame.remote) return Status::kNotADataFrame;
    if (frame.length != kMaxClassicLength) return Status::kWrongLength;
    newest_us_ = std::max(newest_us_, time_us);
    const Data data = std::span<const std::uint8_t>(frame.data).first<kMaxClassicLength>();
    if (command == kHeartbeatCommand) return take_heartbeat(joint, data, time_us);
    if (command == kEncoderCommand) return take_encoder(joint, data, time_us);
    return take_torque(joint, data, time_us);
  }

  Status overhear_of(std::size_t joint, std::uint32_t command, Data data, Microseconds time_us) {
    Axis& axis = state_[joint];
    if (command == kTorqueCommand) {
      const float torque = first_float(data) / motor_torque_per_joint_torque(joint);
      if (!is_finite(torque)) return Status::kInvalidValue;
      axis.commanded_torque = torque;
      return Status::kOk;
    }
    const bool drives = from_little_endian(data.first<4>()) == kClosedLoop;
    const DriveMode asked = drives ? DriveMode::kTorque : DriveMode::kOff;
    axis.told_to_drive = drives;
    axis.asked_us = time_us;
    if (axis.mode == asked) return Status::kOk;
    axis.mode = asked;
    axis.heartbeat.seen = false;
    return Status::kOk;
  }

  // Bytes 5 to 7 are errors of motor, encoder and controller in firmware 0.5 (none before 0.5.6),
  // the result of the last procedure and "trajectory done" in 0.6.
  Status take_heartbeat(std::size_t joint, Data data, Microseconds time_us) {
    Axis& axis = state_[joint];
    const bool old = axes_[joint].firmware == CanSimpleFirmware::k05;
    const bool encoder_failed = old && (data[6] & 1U) != 0;
    const bool failed = from_little_endian(data.first<4>()) != 0 ||
                        (old && ((data[5] & 1U) != 0 || (data[7] & 1U) != 0));
    axis.flags = static_cast<std::uint8_t>((encoder_failed ? kEncoderFault : 0) |
                                           (failed ? kDriveFault : 0));
    axis.heartbeat = {true, time_us};
    const bool early = axis.told_to_drive && time_us - axis.asked_us < kStateTimeUs;
    if (early) return Status::kOk;
    axis.mode = data[4] == kClosedLoop ? DriveMode::kTorque : DriveMode::kOff;
    axis.refused = axis.told_to_drive && axis.mode == DriveMode::kOff;
    return Status::kOk;
  }

  Status take_encoder(std::size_t joint, Data data, Microseconds time_us) {
    const float per_turn = axes_[joint].joint_per_turn;
    const EncoderReading reading{first_float(data) * per_turn, last_float(data) * per_turn, true};
    if (!is_finite(reading.position) || !is_finite(reading.velocity)) {
      return Status::kInvalidValue;
    }
    state_[joint].reading = reading;
    state_[joint].encoder = {true, time_us};
    return Status::kOk;
  }

  // Target and estimate; of the motor's torque, or of its current.
  Status take_torque(std::size_t joint, Data data, Microseconds time_us) {
    const CanSimpleAxis& axis = axes_[joint];
    const float scale = axis.firmware == CanSimpleFirmware::k05 ? axis.motor_nm_per_ampere : 1.0F;
    const float torque = last_float(data) * scale / motor_torque_per_joint_torque(joint);
    if (!is_finite(torque)) return Status::kInvalidValue;
    state_[joint].reported_torque = torque;
    state_[joint].torque = {true, time_us};
    return Status::kOk;
  }

  static float first_float(Data data) {
    return std::bit_cast<float>(from_little_endian(data.first<4>()));
  }
  static float last_float(Data data) {
    return std::bit_cast<float>(from_little_endian(data.last<4>()));
  }

  [[nodiscard]] Frame torque_frame(std::size_t joint, float torque) const {
    return word_frame(joint, kTorqueCommand,
                      std::bit_cast<std::uint32_t>(torque * motor_torque_per_joint_torque(joint)));
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
  Axes axes_;
  Status configuration_;
  PerJoint<static_cast<int>(Joints), Axis> state_{};
  Microseconds newest_us_ = 0;  // when the newest of the axes' frames came: this side has no clock
};

static_assert(OverheardProtocol<CanSimpleDrives<2>>);

// Programs choose them by this (drive_description.hpp).
struct CanSimple {
  static constexpr const char* kName = "can_simple";
  static constexpr const char* kHeader = "offnominal/hal/protocols/can_simple/can_simple.hpp";
  static constexpr const char* kType = "offnominal::hal::CanSimple";
  static constexpr bool kHasFd = false;
  static constexpr bool kHasPositionsAlone = false;
  static constexpr bool kHasDbc = false;

  // CanSimpleFirmware in their order.
  static constexpr std::array<const char*, 2> kFirmwares{"0.5", "0.6"};
  enum Key : std::uint8_t { kFirmware, kEncoderInterval, kHeartbeatInterval, kTorqueInterval };
  static constexpr std::array<DriveKey, 4> kKeys{{
      {.name = "firmware",
       .meaning = "of every axis",
       .most = 1,
       .otherwise = 1,
       .words = kFirmwares},
      {.name = "encoder_interval_s",
       .unit = "s",
       .meaning = "of Get_Encoder_Estimates, whole ms, at most `estimator.period_s`",
       .least = 0.001,
       .most = 0.1,
       .otherwise = 0.001},
      {.name = "heartbeat_interval_s",
       .unit = "s",
       .meaning = "of Heartbeat, whole ms",
       .least = 0.001,
       .most = 0.1,
       .otherwise = 0.1},
      {.name = "torque_interval_s",
       .unit = "s",
       .meaning = "of Get_Torques (0.6) or Get_Iq (0.5), whole ms; 0: not sent, the commanded "
                  "torque is taken for the one applied",
       .least = 0,
       .most = 0.1,
       .otherwise = 0},
  }};
  enum JointKey : std::uint8_t { kNode, kJointPerTurn, kMotorNmPerAmpere };
  static constexpr std::array<DriveKey, 3> kJointKeys{{
      {.name = "node",
       .meaning = "axis node id, another of every joint",
       .most = 63,
       .required = true,
       .whole = true,
       .differs = true},
      {.name = "joint_per_turn",
       .unit = "rad or m",
       .meaning = "of the joint, per turn of the motor; negative where they turn against each "
                  "other, not 0",
       .least = -1000,
       .most = 1000,
       .required = true},
      {.name = "motor_nm_per_ampere",
       .unit = "N m/A",
       .meaning = "the motor's `torque_constant`, negative where its direction is -1; needed by "
                  "firmware 0.5 with `torque_interval_s` above 0",
       .least = -1000,
       .most = 1000},
  }};

  template <std::size_t Joints>
  using Drives = CanSimpleDrives<Joints>;

  template <std::size_t Joints>
  [[nodiscard]] static Drives<Joints> drives(const DriveValues& values, const DriveLink& /*link*/,
                                             std::size_t joints = Joints) {
    auto axes = per_joint<Joints, CanSimpleAxis>(joints);
    for (std::size_t j = 0; j < axes.size(); ++j) axes[j] = axis_of(values, j);
    return Drives<Joints>(config_of(values), axes);
  }

  [[nodiscard]] static constexpr CanSimpleConfig config_of(const DriveValues& values) {
    return {.encoder_interval_us = microseconds(values.shared[kEncoderInterval]),
            .heartbeat_interval_us = microseconds(values.shared[kHeartbeatInterval]),
            .torque_interval_us = microseconds(values.shared[kTorqueInterval])};
  }
  [[nodiscard]] static constexpr CanSimpleAxis axis_of(const DriveValues& values,
                                                       std::size_t joint) {
    const auto of_joint = values.of_joints.subspan(joint * kJointKeys.size(), kJointKeys.size());
    const bool old = values.shared[kFirmware] == 0;
    return {.node = static_cast<std::uint8_t>(of_joint[kNode]),
            .joint_per_turn = static_cast<float>(of_joint[kJointPerTurn]),
            .firmware = old ? CanSimpleFirmware::k05 : CanSimpleFirmware::k06,
            .motor_nm_per_ampere = static_cast<float>(of_joint[kMotorNmPerAmpere])};
  }

  [[nodiscard]] static DriveFault fault_of(const DriveValues& values, double period_s) {
    for (const Key key : {kEncoderInterval, kHeartbeatInterval, kTorqueInterval}) {
      const double interval_ms = 1e3 * values.shared[key];
      if (std::fabs(interval_ms - std::round(interval_ms)) < 1e-6) continue;
      return {kKeys[key].name, "a part of a millisecond", "whole milliseconds"};
    }
    if (values.shared[kEncoderInterval] > period_s * (1 + 1e-6)) {
      return {kKeys[kEncoderInterval].name, "ticks without a reading",
              "at most estimator.period_s: every tick needs a reading"};
    }
    const CanSimpleConfig config = config_of(values);
    for (std::size_t j = 0; j < values.of_joints.size() / kJointKeys.size(); ++j) {
      const CanSimpleAxis axis = axis_of(values, j);
      if (axis.joint_per_turn == 0) {
        return {kJointKeys[kJointPerTurn].name, "0", "another number: the gear and its sign"};
      }
      const bool tells_current =
          axis.firmware == CanSimpleFirmware::k05 && config.torque_interval_us > 0;
      if (!tells_current || axis.motor_nm_per_ampere != 0) continue;
      return {kJointKeys[kMotorNmPerAmpere].name, "none, with firmware 0.5 that tells its current",
              "the motor's torque_constant for every joint"};
    }
    return {};
  }

  // All of them are as long as frames of classic CAN are.
  [[nodiscard]] static double busy_share(const DriveValues& values, std::size_t joints,
                                         FrameFormat format, double period_s) {
    double frames_per_s = 1 / period_s;
    for (const Key key : {kEncoderInterval, kHeartbeatInterval, kTorqueInterval}) {
      if (values.shared[key] > 0) frames_per_s += 1 / values.shared[key];
    }
    return static_cast<double>(joints) * frames_per_s *
           longest_wire_time_s(reading_frame(joints, format));
  }

  [[nodiscard]] static bool heartbeat_in(const Frame& /*frame*/, Heartbeat& /*into*/) {
    return false;
  }

  [[nodiscard]] static Frame reading_frame(std::size_t /*joints*/, FrameFormat /*format*/) {
    Frame frame;
    frame.length = kMaxClassicLength;
    return frame;
  }

  // All that an axis and a controller say to each other has the axis' node in it.
  [[nodiscard]] static std::size_t from_drives(const DriveValues& values,
                                               std::span<IdFilter> into) {
    const std::size_t joints = values.of_joints.size() / kJointKeys.size();
    for (std::size_t j = 0; j < joints; ++j) {
      into[j] = {.id = std::uint32_t{axis_of(values, j).node} << 5U, .mask = 0x7E0};
    }
    return joints;
  }
  [[nodiscard]] static std::size_t from_controller(const DriveValues& values,
                                                   std::span<IdFilter> into) {
    return from_drives(values, into);
  }

 private:
  static constexpr Microseconds microseconds(double seconds) {
    constexpr double kHalf = 0.5;
    const double whole = 1e6 * seconds + kHalf;
    return static_cast<Microseconds>(whole);
  }
};

}  // namespace offnominal::hal
