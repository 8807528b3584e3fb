// Emulated ODrive axes, one a joint, as [drives] of a robot file describes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>
#include <span>
#include <stdexcept>
#include <vector>

#include "offnominal/sim/bus/drives.hpp"
#include "offnominal/sim/bus/odrive_axis.hpp"

namespace offnominal::sim {

/// Calibrated axes in torque control, with the watch-dog that docs/can-simple.md asks for. What
/// stands in [drives] is taken for what the axes are configured to; the gear is without loss.
class OdriveDrives final : public Drives {
 public:
  /// Of values that hal::CanSimple::fault_of() takes. Throws std::invalid_argument for joints that
  /// they are not of, or that there may not be.
  OdriveDrives(const hal::DriveValues& values, const DriveSetup& setup)
      : period_us_(setup.link.period_us) {
    const hal::CanSimpleConfig config = hal::CanSimple::config_of(values);
    if (values.of_joints.size() != setup.joints * hal::CanSimple::kJointKeys.size()) {
      throw std::invalid_argument("drives: found settings of other joints");
    }
    for (std::size_t j = 0; j < checked_joints(setup.joints); ++j) {
      const hal::CanSimpleAxis axis = hal::CanSimple::axis_of(values, j);
      OdriveConfig of_axis;
      of_axis.node = axis.node;
      of_axis.firmware_06 = axis.firmware == hal::CanSimpleFirmware::k06;
      of_axis.heartbeat_ms = milliseconds(config.heartbeat_interval_us);
      of_axis.encoder_ms = milliseconds(config.encoder_interval_us);
      of_axis.torque_ms = milliseconds(config.torque_interval_us);
      of_axis.watchdog_ms = kWatchdogMs;
      if (axis.motor_nm_per_ampere != 0) {
        of_axis.torque_constant = static_cast<double>(axis.motor_nm_per_ampere);
      }
      axes_.emplace_back(of_axis);
      joint_per_turn_.push_back(static_cast<double>(axis.joint_per_turn));
      nodes_.push_back(axis.node);
      axes_.back().max_torque_nm = setup.max_torque_nm * std::fabs(motor_share(j));
    }
    commands_.resize(setup.joints);
  }

  [[nodiscard]] std::size_t joints() const override { return axes_.size(); }

  bool take(const hal::ReceivedFrame& received) override {
    const hal::Frame& frame = received.frame;
    bool mine = false;
    for (std::size_t j = 0; j < joints(); ++j) {
      axes_[j].take(frame);
      if (frame.extended || frame.fd || frame.id != command_id(j)) continue;
      ++commands_[j];
      mine = true;
    }
    return mine;
  }

  /// An axis has milliseconds of its own: as many as there were whole periods since the last tick,
  /// the rest later, so that a tick that jitters makes none too many.
  void tick(hal::Microseconds now_us) override {
    const auto periods = static_cast<double>(now_us - last_us_) / static_cast<double>(period_us_);
    ahead_us_ += period_us_ * (has_ticked_ ? std::max(std::llround(periods), 1LL) : 1LL);
    last_us_ = now_us;
    has_ticked_ = true;
    for (; ahead_us_ >= 1000; ahead_us_ -= 1000) {
      for (OdriveAxis& axis : axes_) axis.tick();
    }
  }

  [[nodiscard]] hal::DriveMode mode(std::size_t joint) const override {
    return axes_[joint].state() == OdriveAxis::kClosedLoop ? hal::DriveMode::kTorque
                                                           : hal::DriveMode::kOff;
  }
  /// Power is the same on both sides of the gear.
  [[nodiscard]] double torque_nm(std::size_t joint, double /*speed_rad_s*/) const override {
    return axes_[joint].torque_nm() / motor_share(joint);
  }
  [[nodiscard]] std::uint32_t commands(std::size_t joint) const override {
    return commands_[joint];
  }

  /// Heartbeats, estimates and torques that are due. An axis whose encoder has failed lets go with
  /// that error, and goes on to send position 0, as firmware 0.5 does.
  std::size_t frames(std::span<const Reading> readings, std::span<const double> /*applied_nm*/,
                     std::span<hal::Frame> into) override {
    std::size_t count = 0;
    for (std::size_t j = 0; j < joints(); ++j) {
      if (!readings[j]) axes_[j].fail(OdriveAxis::kEncoderFailed);
      const hal::EncoderReading reading = readings[j].value_or(hal::EncoderReading{});
      const double turns = static_cast<double>(reading.position) / joint_per_turn_[j];
      const double turns_per_s = static_cast<double>(reading.velocity) / joint_per_turn_[j];
      for (const hal::Frame& frame : axes_[j].frames(turns, turns_per_s)) into[count++] = frame;
    }
    return count;
  }

  [[nodiscard]] hal::DriveCounts counts() const override { return {}; }

  [[nodiscard]] bool concerns(const hal::Frame& frame, std::size_t joint) const override {
    return !frame.extended && !frame.fd && frame.id >> 5U == nodes_[joint];
  }
  [[nodiscard]] std::uint32_t reading_id(std::size_t joint) const override {
    return std::uint32_t{nodes_[joint]} << 5U | 0x09U;
  }
  [[nodiscard]] std::uint32_t command_id(std::size_t joint) const override {
    return std::uint32_t{nodes_[joint]} << 5U | 0x0EU;
  }

 private:
  static constexpr int kWatchdogMs = 50;

  static int milliseconds(hal::Microseconds us) { return static_cast<int>(us / 1000); }
  [[nodiscard]] double motor_share(std::size_t joint) const {
    return joint_per_turn_[joint] / (2 * std::numbers::pi);
  }

  hal::Microseconds period_us_;
  hal::Microseconds last_us_ = 0;
  hal::Microseconds ahead_us_ = 0;
  bool has_ticked_ = false;
  std::vector<OdriveAxis> axes_;
  std::vector<double> joint_per_turn_;
  std::vector<std::uint8_t> nodes_;
  std::vector<std::uint32_t> commands_;
};

}  // namespace offnominal::sim
