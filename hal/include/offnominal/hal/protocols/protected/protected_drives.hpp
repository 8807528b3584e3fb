#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/wire_time.hpp>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <offnominal/hal/source.hpp>
#include <offnominal/joint_count.hpp>
#include <span>

namespace offnominal::hal {

// Records of joints 1, 2, ... in as many frames as the format takes, into the front of `into`;
// returns how many: one a joint, or one for every 8.
[[nodiscard]] constexpr std::size_t pack(MessageKind kind, std::span<const Record> records,
                                         FrameFormat format, std::span<Frame> into) {
  std::size_t count = 0;
  if (format == FrameFormat::kClassic) {
    for (; count < records.size(); ++count) {
      write_frame(kind, static_cast<std::uint8_t>(count), records[count], into[count]);
    }
    return count;
  }
  for (std::size_t first = 0; first < records.size(); first += kMaxRecordsPerFrame) {
    const std::size_t size = std::min<std::size_t>(kMaxRecordsPerFrame, records.size() - first);
    static_cast<void>(group_frame_of(kind, static_cast<std::uint8_t>(first),
                                     records.subspan(first, size), into[count++]));
  }
  return count;
}

// One sender's messages of one kind, joint by joint, as they come in.
template <typename Message, std::size_t Joints>
class Inbox {
 public:
  Inbox() = default;
  explicit Inbox(std::size_t joints)
      : sources_(per_joint<Joints, Source>(joints)), newest_(per_joint<Joints, Message>(joints)) {}

  // The record of joint `node`, which came at time_us.
  [[nodiscard]] Status take(const SourceConfig& config, MessageKind kind, std::size_t node,
                            std::span<const std::uint8_t, kRecordLength> record,
                            Microseconds time_us) {
    Source& source = sources_[node];
    Message message;
    std::uint8_t counter = 0;
    Status status =
        decode(record, data_id_of(kind, static_cast<std::uint8_t>(node)), message, counter);
    if (status != Status::kOk) {
      reject(config, source);
      return status;
    }
    status = accept(config, counter, time_us, source);
    if (status == Status::kOk) newest_[node] = message;
    return status;
  }

  [[nodiscard]] const Message& newest(std::size_t node) const { return newest_[node]; }
  [[nodiscard]] const Source& source(std::size_t node) const { return sources_[node]; }

 private:
  PerJoint<static_cast<int>(Joints), Source> sources_{};
  PerJoint<static_cast<int>(Joints), Message> newest_{};
};

// offnominal's own frames (address.hpp, messages.hpp), every record with counter and CRC. Joints: a
// number, or kAnyJoints for one that the constructor is given.
template <std::size_t Joints>
class ProtectedDrives {
 public:
  static constexpr std::size_t kJoints = Joints;
  static constexpr std::size_t kMost = kMostDrives<Joints>;
  static constexpr std::size_t kMaxOutgoing = kMost + 1;
  static_assert(kMost >= 1 && kMost < kControllerNode);

  ProtectedDrives(const SourceConfig& encoder, const SourceConfig& drive, FrameFormat format,
                  std::size_t joints = Joints)
      : encoder_config_(encoder),
        drive_config_(drive),
        format_(format),
        encoders_(joints),
        drives_(joints),
        torque_counters_(per_joint<Joints, std::uint8_t>(joints)) {}

  [[nodiscard]] Status take(const ReceivedFrame& received) {
    Address address;
    if (const Status status = address_of(received.frame, address); status != Status::kOk) {
      return status;
    }
    Status worst = Status::kOk;
    for (std::size_t i = 0; i < address.count; ++i) {
      const std::size_t node = address.first_node + i;
      const Status status =
          take_record(address.kind, node, record_in(received.frame, i), received.time_us);
      if (status != Status::kOk) worst = status;
    }
    return worst;
  }

  [[nodiscard]] JointFeedback feedback(std::size_t joint, Microseconds now_us) const {
    const Source& encoder = encoders_.source(joint);
    return {state_of(encoder_config_, encoder, now_us),
            state_of(drive_config_, drives_.source(joint), now_us), encoder.time_us,
            encoders_.newest(joint), drives_.newest(joint)};
  }

  [[nodiscard]] std::size_t outgoing(std::span<const TorqueCommand> commands,
                                     const Heartbeat& heartbeat, std::span<Frame> into) {
    std::array<Record, kMost> records{};
    const std::size_t joints = torque_counters_.size();
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const auto node = static_cast<std::uint8_t>(joint);
      const std::uint16_t id = data_id_of(MessageKind::kTorqueCommand, node);
      const std::uint8_t counter = torque_counters_[joint]++;
      if (encode(commands[joint], counter, id, records[joint]) != Status::kOk) {
        static_cast<void>(encode(TorqueCommand{}, counter, id, records[joint]));
      }
    }
    std::size_t count = pack(MessageKind::kTorqueCommand,
                             std::span<const Record>(records).first(joints), format_, into);
    if (heartbeat.ticks % kHeartbeatTicks != 0) return count;
    Record record{};
    static_cast<void>(encode(heartbeat, heartbeat_counter_++,
                             data_id_of(MessageKind::kHeartbeat, kControllerNode), record));
    into[count++] = frame_of(MessageKind::kHeartbeat, kControllerNode, record);
    return count;
  }

  // Its drives say all that there is.
  [[nodiscard]] static Status overhear(const ReceivedFrame& /*received*/) {
    return Status::kUnknownId;
  }

  [[nodiscard]] bool report(const Diagnosis& found, Frame& into) {
    return tell(MessageKind::kDiagnosis, found, diagnosis_counter_, into);
  }
  [[nodiscard]] bool report(const FaultReport& fault, Frame& into) {
    return tell(MessageKind::kFault, fault, fault_counter_, into);
  }

  [[nodiscard]] Microseconds drive_max_age_us() const { return drive_config_.max_age_us; }

  [[nodiscard]] bool stop_seen() const { return stop_seen_; }
  void clear_stop() { stop_seen_ = false; }

  [[nodiscard]] DriveCounts counts() const {
    DriveCounts counts;
    for (std::size_t joint = 0; joint < torque_counters_.size(); ++joint) {
      for (const Source* source : {&encoders_.source(joint), &drives_.source(joint)}) {
        counts.lost += source->lost;
        counts.rejected += std::uint64_t{source->rejected} + source->repeated;
      }
    }
    return counts;
  }
  [[nodiscard]] const Source& encoder_source(std::size_t joint) const {
    return encoders_.source(joint);
  }
  [[nodiscard]] const Source& drive_source(std::size_t joint) const {
    return drives_.source(joint);
  }

 private:
  template <typename Message>
  static bool tell(MessageKind kind, const Message& message, std::uint8_t& counter, Frame& into) {
    Record record{};
    if (encode(message, counter, data_id_of(kind, kControllerNode), record) != Status::kOk) {
      return false;
    }
    ++counter;
    into = frame_of(kind, kControllerNode, record);
    return true;
  }

  Status take_record(MessageKind kind, std::size_t node,
                     std::span<const std::uint8_t, kRecordLength> record, Microseconds time_us) {
    switch (kind) {
      case MessageKind::kEncoder:
        // What a CAN FD group has too much, by its length.
        if (node >= torque_counters_.size()) return Status::kOk;
        return encoders_.take(encoder_config_, kind, node, record, time_us);
      case MessageKind::kDriveStatus:
        if (node >= torque_counters_.size()) return Status::kOk;
        return drives_.take(drive_config_, kind, node, record, time_us);
      case MessageKind::kEmergencyStop: {
        EmergencyStop stop;
        std::uint8_t counter = 0;
        const Status status =
            decode(record, data_id_of(kind, static_cast<std::uint8_t>(node)), stop, counter);
        // An old one that is played back is a stop as well: there is no wrong time for it.
        if (status == Status::kOk) stop_seen_ = true;
        return status;
      }
      case MessageKind::kTorqueCommand:
      case MessageKind::kHeartbeat:
      case MessageKind::kDiagnosis:
      case MessageKind::kFault:
        break;
    }
    return Status::kUnknownId;
  }

  SourceConfig encoder_config_;
  SourceConfig drive_config_;
  FrameFormat format_;
  Inbox<EncoderReading, Joints> encoders_;
  Inbox<DriveStatus, Joints> drives_;
  PerJoint<static_cast<int>(Joints), std::uint8_t> torque_counters_{};
  std::uint8_t heartbeat_counter_ = 0;
  std::uint8_t diagnosis_counter_ = 0;
  std::uint8_t fault_counter_ = 0;
  bool stop_seen_ = false;
};

static_assert(OverheardProtocol<ProtectedDrives<2>>);

// Programs choose them by this (drive_description.hpp).
struct Protected {
  static constexpr const char* kName = "protected";
  static constexpr const char* kHeader = "offnominal/hal/protocols/protected/protected_drives.hpp";
  static constexpr const char* kType = "offnominal::hal::Protected";
  static constexpr std::array<DriveKey, 0> kKeys{};
  static constexpr std::array<DriveKey, 0> kJointKeys{};
  static constexpr bool kHasFd = true;
  static constexpr bool kHasPositionsAlone = true;
  static constexpr bool kHasDbc = true;

  template <std::size_t Joints>
  using Drives = ProtectedDrives<Joints>;

  template <std::size_t Joints>
  [[nodiscard]] static Drives<Joints> drives(const DriveValues& /*values*/, const DriveLink& link,
                                             std::size_t joints = Joints) {
    const SourceConfig source = source_config(link.period_us);
    return Drives<Joints>(source, source, link.format, joints);
  }

  [[nodiscard]] static DriveFault fault_of(const DriveValues& /*values*/, double /*period_s*/) {
    return {};
  }

  // Reading, status and command of every joint.
  [[nodiscard]] static double busy_share(const DriveValues& /*values*/, std::size_t joints,
                                         FrameFormat format, double period_s) {
    double busy_s = 0;
    for (const MessageKind kind :
         {MessageKind::kEncoder, MessageKind::kDriveStatus, MessageKind::kTorqueCommand}) {
      std::array<Frame, kMaxNodes> frames;
      const std::size_t count = packed(kind, joints, format, frames);
      for (std::size_t i = 0; i < count; ++i) busy_s += longest_wire_time_s(frames[i]);
    }
    return busy_s / period_s;
  }

  [[nodiscard]] static Frame reading_frame(std::size_t joints, FrameFormat format) {
    std::array<Frame, kMaxNodes> frames;
    static_cast<void>(packed(MessageKind::kEncoder, joints, format, frames));
    return frames[0];
  }

  [[nodiscard]] static bool heartbeat_in(const Frame& frame, Heartbeat& into) {
    Address address;
    if (address_of(frame, address) != Status::kOk) return false;
    if (address.kind != MessageKind::kHeartbeat) return false;
    std::uint8_t counter = 0;
    const std::uint16_t id = data_id_of(address.kind, address.first_node);
    return decode(record_in(frame, 0), id, into, counter) == Status::kOk;
  }

  // Stops, readings, statuses; torque commands, heartbeats, diagnoses and faults.
  [[nodiscard]] static std::size_t from_drives(const DriveValues& /*values*/,
                                               std::span<IdFilter> into) {
    into[0] = {.id = 0x020, .mask = 0x7E0};
    into[1] = {.id = 0x180, .mask = 0x7C0};
    into[2] = {.id = 0x200, .mask = 0x7C0};
    return 3;
  }
  [[nodiscard]] static std::size_t from_controller(const DriveValues& /*values*/,
                                                   std::span<IdFilter> into) {
    into[0] = {.id = 0x100, .mask = 0x7C0};
    into[1] = {.id = 0x700, .mask = 0x780};
    return 2;
  }

 private:
  static std::size_t packed(MessageKind kind, std::size_t joints, FrameFormat format,
                            std::span<Frame> into) {
    const std::array<Record, kMaxNodes> records{};
    return pack(kind, std::span<const Record>(records).first(joints), format, into);
  }
};

}  // namespace offnominal::hal
