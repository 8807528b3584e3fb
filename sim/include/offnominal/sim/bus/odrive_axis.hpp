// One axis of an ODrive on a CAN bus, as its firmware behaves towards a torque controller: states,
// errors, watch-dog, cyclic messages. Written from ODrive's firmware 0.5 (Firmware/MotorControl/
// axis.cpp, communication/can/can_simple.cpp) and the message tables of firmware 0.6, not from the
// driver in hal that it tests.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <utility>
#include <vector>

namespace offnominal::sim {

struct OdriveConfig {
  std::uint8_t node = 0;
  bool firmware_06 = true;  ///< else 0.5.6
  /// axis.config.can: of the cyclic messages; 0: not sent.
  int heartbeat_ms = 100;
  int encoder_ms = 1;
  int torque_ms = 0;              ///< 0.6: Get_Torques, 0.5: Get_Iq
  int watchdog_ms = 0;            ///< 0: not enabled
  double torque_constant = 0.05;  ///< N m/A
  double current_bandwidth_rad_s = 1000;
  bool calibrated = true;
};

/// Time goes on in milliseconds, as the firmware's state machine does.
class OdriveAxis {
 public:
  enum State : std::uint8_t { kIdle = 1, kClosedLoop = 8 };
  /// Bits of Axis_Error that both firmwares have in one way or another.
  enum Error : std::uint32_t {
    kInvalidState = 0x1,     // 0.6: INITIALIZING
    kMotorFailed = 0x40,     // 0.6: MISSING_INPUT
    kEncoderFailed = 0x100,  // 0.6: another number, an error all the same
    kEstopRequested = 0x4000,
    kWatchdogExpired = 0x800,
  };

  explicit OdriveAxis(const OdriveConfig& config) : config_(config) {}

  /// A frame from the bus; others' are ignored.
  void take(const hal::Frame& frame) {
    if (frame.extended || frame.fd || frame.id >> 5U != config_.node) return;
    const std::uint32_t command = frame.id & 0x1FU;
    // 0.5 is fed by any message, 0.6 by new inputs.
    if (!config_.firmware_06 || command == kSetInputTorque) fed_ms_ = 0;
    if (command == kEstop) fail(kEstopRequested);
    if (command == kClearErrors) error_ = 0;
    if (command == kSetAxisState) {
      requested_ = static_cast<std::uint8_t>(word(frame));
      requests_ += requested_ == kClosedLoop ? 1 : 0;
    }
    if (command == kSetInputTorque) input_torque_ = std::bit_cast<float>(word(frame));
  }

  /// One millisecond.
  void tick() {
    ++now_ms_;
    ++fed_ms_;
    if (requested_ != 0) obey(std::exchange(requested_, std::uint8_t{0}));
    if (entering_ms_ > 0 && --entering_ms_ == 0) {
      state_ = kClosedLoop;
      fed_ms_ = 0;
    }
    const bool fed = config_.watchdog_ms == 0 || fed_ms_ <= config_.watchdog_ms;
    if (state_ == kClosedLoop && !fed) fail(kWatchdogExpired);
    const double wanted =
        std::clamp(static_cast<double>(input_torque_), -max_torque_nm, max_torque_nm);
    const double share = 1 - std::exp(-1e-3 * config_.current_bandwidth_rad_s);
    torque_nm_ = state_ == kClosedLoop ? torque_nm_ + share * (wanted - torque_nm_) : 0.0;
  }

  /// The cyclic messages that have become due since the last call, one of each at most, for a motor
  /// at so many turns and turns a second.
  [[nodiscard]] std::vector<hal::Frame> frames(double turns, double turns_per_s) {
    std::vector<hal::Frame> due;
    if (!silent_heartbeat && is_due(config_.heartbeat_ms)) due.push_back(heartbeat());
    if (is_due(config_.encoder_ms)) due.push_back(floats(kGetEncoderEstimates, turns, turns_per_s));
    if (!silent_torque && is_due(config_.torque_ms)) {
      const double scale = config_.firmware_06 ? 1.0 : config_.torque_constant;
      const std::uint32_t command = config_.firmware_06 ? kGetTorques : kGetIq;
      due.push_back(
          floats(command, static_cast<double>(input_torque_) / scale, torque_nm_ / scale));
    }
    told_ms_ = now_ms_;
    return due;
  }

  /// An error of the axis: it lets go.
  void fail(std::uint32_t error) {
    error_ |= error;
    drop_out();
  }
  /// Lets go without an axis error, as 0.5.4 does where motor or encoder fail
  /// (github.com/odriverobotics/ODrive/issues/700).
  void drop_out() {
    state_ = kIdle;
    entering_ms_ = 0;
  }

  [[nodiscard]] std::uint8_t state() const { return state_; }
  [[nodiscard]] double torque_nm() const { return torque_nm_; }  ///< of the motor, as it acts
  [[nodiscard]] int requests() const { return requests_; }       ///< for closed loop

  double max_torque_nm = 1e3;  ///< of the motor; less where it is hot, or its supply is weak
  bool silent_heartbeat = false;
  bool silent_torque = false;
  bool refuses = false;  ///< requests, without a word

 private:
  enum Command : std::uint32_t {
    kHeartbeat = 0x01,
    kEstop = 0x02,
    kSetAxisState = 0x07,
    kGetEncoderEstimates = 0x09,
    kSetInputTorque = 0x0E,
    kGetIq = 0x14,
    kClearErrors = 0x18,
    kGetTorques = 0x1C,
  };

  // Every request ends the state that the axis is in, closed loop as well: the motor is disarmed
  // and armed again after some turns of the control loop.
  void obey(std::uint8_t state) {
    if (refuses) return;
    constexpr int kEnterMs = 3;
    drop_out();
    if (state == kIdle) return;
    if (state != kClosedLoop || !config_.calibrated) return fail(kInvalidState);
    if (error_ == 0) entering_ms_ = kEnterMs;
  }

  [[nodiscard]] bool is_due(int interval_ms) const {
    const auto count_at = [&](std::int64_t ms) { return (ms + config_.node) / interval_ms; };
    return interval_ms > 0 && count_at(now_ms_) != count_at(told_ms_);
  }

  static std::uint32_t word(const hal::Frame& frame) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) value |= std::uint32_t{frame.data[i]} << (8 * i);
    return value;
  }
  static void put_word(std::uint32_t value, unsigned at, hal::Frame& frame) {
    for (unsigned i = 0; i < 4; ++i)
      frame.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  [[nodiscard]] hal::Frame frame_of(std::uint32_t command) const {
    hal::Frame frame;
    frame.id = std::uint32_t{config_.node} << 5U | command;
    frame.length = 8;
    return frame;
  }
  [[nodiscard]] hal::Frame floats(std::uint32_t command, double first, double second) const {
    hal::Frame frame = frame_of(command);
    put_word(std::bit_cast<std::uint32_t>(static_cast<float>(first)), 0, frame);
    put_word(std::bit_cast<std::uint32_t>(static_cast<float>(second)), 4, frame);
    return frame;
  }
  [[nodiscard]] hal::Frame heartbeat() const {
    hal::Frame frame = frame_of(kHeartbeat);
    put_word(error_, 0, frame);
    frame.data[4] = state_;
    if (config_.firmware_06) {
      constexpr std::uint8_t kBusy = 1;
      frame.data[5] = entering_ms_ > 0 ? kBusy : 0;
      frame.data[6] = 1;  // trajectory done
    } else {
      frame.data[5] = (error_ & kMotorFailed) != 0 ? 1 : 0;
      frame.data[6] = (error_ & kEncoderFailed) != 0 ? 1 : 0;
      frame.data[7] = 0x80;  // trajectory done
    }
    return frame;
  }

  OdriveConfig config_;
  std::uint8_t state_ = kIdle;
  std::uint8_t requested_ = 0;
  std::uint32_t error_ = 0;
  int entering_ms_ = 0;
  int fed_ms_ = 0;
  int requests_ = 0;
  std::int64_t now_ms_ = 0;
  std::int64_t told_ms_ = 0;  // when frames() was last asked
  float input_torque_ = 0;
  double torque_nm_ = 0;
};

}  // namespace offnominal::sim
