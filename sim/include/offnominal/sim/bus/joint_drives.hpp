// The drives' end of the bus: what stands behind the joints and obeys torque commands.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/messages.hpp>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <offnominal/hal/source.hpp>
#include <span>

#include "offnominal/sim/bus/drives.hpp"

namespace offnominal::sim {

/// How a drive treats what it is told.
struct DriveConfig {
  hal::SourceConfig commands{.max_age_us = 5000, .sequence_needed = 1};
  double max_torque_nm = 1000.0;  ///< N on a joint that slides
  double damping_nm_s = 1.0;      ///< N m s/rad, in DriveMode::kDamping
  /// What it does by itself when commands stay away: kOff or kDamping.
  hal::DriveMode fallback = hal::DriveMode::kOff;
};

/// Drives with offnominal's own frames, one a joint. Each has a watch-dog: without a valid command
/// for commands.max_age_us it falls back, says so in its status, and obeys again with the next
/// valid command that is not kTorque: a torque has to be asked for anew.
class JointDrives final : public Drives {
 public:
  /// Of 1 to kMaxJoints joints; throws std::invalid_argument for others.
  JointDrives(std::size_t joints, const DriveConfig& config, hal::FrameFormat format)
      : joints_(checked_joints(joints)), config_(config), format_(format) {}

  /// As programs make them: watch-dogs let go after 5 periods without a command.
  JointDrives(const hal::DriveValues& /*values*/, const DriveSetup& setup)
      : JointDrives(setup.joints,
                    {.commands = {.max_age_us = 5 * setup.link.period_us, .sequence_needed = 1},
                     .max_torque_nm = setup.max_torque_nm},
                    setup.link.format) {}

  bool take(const hal::ReceivedFrame& received) override {
    hal::Address address;
    if (address_of(received.frame, address) != hal::Status::kOk) return false;
    if (address.kind == hal::MessageKind::kEmergencyStop) stop_at(address, received.frame);
    if (address.kind != hal::MessageKind::kTorqueCommand) return false;
    bool valid = true;
    for (std::size_t i = 0; i < address.count && address.first_node + i < joints_; ++i) {
      const std::size_t joint = address.first_node + i;
      const bool good =
          commands_.take(config_.commands, address.kind, joint, record_in(received.frame, i),
                         received.time_us) == hal::Status::kOk;
      if (good) obey(joint);
      valid = valid && good;
    }
    return valid;
  }

  void tick(hal::Microseconds now_us) override {
    for (std::size_t j = 0; j < joints_; ++j) {
      const hal::SourceState state = state_of(config_.commands, commands_.source(j), now_us);
      if (state == hal::SourceState::kStale || state == hal::SourceState::kError) fall_back(j);
    }
  }

  [[nodiscard]] double torque_nm(std::size_t joint, double speed_rad_s) const override {
    const Drive& drive = drives_[joint];
    switch (drive.mode) {
      case hal::DriveMode::kTorque:
        return limited(static_cast<double>(commands_.newest(joint).torque));
      case hal::DriveMode::kDamping:
        return limited(-config_.damping_nm_s * speed_rad_s);
      case hal::DriveMode::kOff:
        break;
    }
    return 0.0;
  }

  [[nodiscard]] hal::DriveMode mode(std::size_t joint) const override {
    return drives_[joint].mode;
  }
  [[nodiscard]] std::size_t joints() const override { return joints_; }
  [[nodiscard]] std::uint32_t commands(std::size_t joint) const override {
    return source(joint).accepted;
  }
  [[nodiscard]] const hal::Source& source(std::size_t joint) const {
    return commands_.source(joint);
  }

  [[nodiscard]] hal::DriveCounts counts() const override {
    hal::DriveCounts counts;
    for (std::size_t j = 0; j < joints_; ++j) {
      counts.lost += source(j).lost;
      counts.rejected += std::uint64_t{source(j).rejected} + source(j).repeated;
    }
    return counts;
  }

  /// Readings, then statuses with the torque that was applied. A joint without a reading: its frame
  /// is missing, or in a group its record is zero.
  std::size_t frames(std::span<const Reading> readings, std::span<const double> applied_nm,
                     std::span<hal::Frame> into) override {
    std::array<hal::Record, kMost> encoders{};
    std::array<hal::Record, kMost> statuses{};
    for (std::size_t j = 0; j < joints_; ++j) {
      Drive& drive = drives_[j];
      const auto node = static_cast<std::uint8_t>(j);
      std::uint8_t flags = drive.fell_back ? hal::kCommandMissing : 0;
      if (!readings[j]) flags |= hal::kEncoderFault;
      if (drive.mode == hal::DriveMode::kTorque && applied_nm[j] != wanted_nm(j)) {
        flags |= hal::kTorqueLimited;
      }
      // A reading that no frame can carry leaves a record of zeros, which no receiver takes.
      if (readings[j]) {
        static_cast<void>(encode(*readings[j], drive.encoder_counter++,
                                 data_id_of(hal::MessageKind::kEncoder, node), encoders[j]));
      }
      static_cast<void>(encode(
          hal::DriveStatus{drive.mode, flags, static_cast<float>(applied_nm[j])},
          drive.status_counter++, data_id_of(hal::MessageKind::kDriveStatus, node), statuses[j]));
    }
    const auto of_all = [&](const std::array<hal::Record, kMost>& records) {
      return std::span<const hal::Record>(records).first(joints_);
    };
    const std::size_t count = pack(hal::MessageKind::kEncoder, of_all(encoders), format_, into);
    return count +
           pack(hal::MessageKind::kDriveStatus, of_all(statuses), format_, into.subspan(count));
  }

  /// A group of CAN FD is sent by one node for all.
  [[nodiscard]] bool concerns(const hal::Frame& frame, std::size_t joint) const override {
    hal::Address address;
    if (address_of(frame, address) != hal::Status::kOk) return false;
    return joint >= address.first_node && joint < std::size_t{address.first_node} + address.count;
  }
  [[nodiscard]] std::uint32_t reading_id(std::size_t joint) const override {
    return id_of(hal::MessageKind::kEncoder, static_cast<std::uint8_t>(joint));
  }
  [[nodiscard]] std::uint32_t command_id(std::size_t joint) const override {
    return id_of(hal::MessageKind::kTorqueCommand, static_cast<std::uint8_t>(joint));
  }

 private:
  static constexpr auto kMost = static_cast<std::size_t>(kMaxJoints);

  struct Drive {
    hal::DriveMode mode = hal::DriveMode::kOff;
    bool fell_back = false;
    std::uint8_t encoder_counter = 0;
    std::uint8_t status_counter = 0;
  };

  [[nodiscard]] double wanted_nm(std::size_t joint) const {
    return static_cast<double>(commands_.newest(joint).torque);
  }
  [[nodiscard]] double limited(double torque) const {
    return std::clamp(torque, -config_.max_torque_nm, config_.max_torque_nm);
  }
  void obey(std::size_t joint) {
    Drive& drive = drives_[joint];
    const hal::DriveMode asked = commands_.newest(joint).mode;
    if (drive.fell_back && asked == hal::DriveMode::kTorque) return;
    drive.fell_back = false;
    drive.mode = asked;
  }
  void stop_at(const hal::Address& address, const hal::Frame& frame) {
    hal::EmergencyStop stop;
    std::uint8_t counter = 0;
    const std::uint16_t id = data_id_of(address.kind, address.first_node);
    if (decode(record_in(frame, 0), id, stop, counter) != hal::Status::kOk) return;
    for (std::size_t j = 0; j < joints_; ++j) fall_back(j);
  }
  void fall_back(std::size_t joint) {
    Drive& drive = drives_[joint];
    drive.fell_back = true;
    drive.mode = config_.fallback;
  }

  std::size_t joints_;
  DriveConfig config_;
  hal::FrameFormat format_;
  hal::Inbox<hal::TorqueCommand, kMost> commands_;
  std::array<Drive, kMost> drives_{};
};

}  // namespace offnominal::sim
