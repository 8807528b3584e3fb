// The joint controller between a bus and drives that do and say what a test tells them: all that
// goes in is chosen, all that comes out is seen.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace offnominal::test {

class ScriptedBus {
 public:
  struct Sent {
    hal::Frame frame;
    hal::Microseconds deadline_us = 0;
  };
  hal::Microseconds time_us = 0;
  hal::BusMode mode = hal::BusMode::kActive;
  hal::Status sending = hal::Status::kOk;
  std::size_t waiting = 0;  // frames that have come, not yet fetched
  std::size_t fetches = 0;
  // What has been taken since the beginning, less what was dropped.
  std::vector<Sent> sent;
  int drops = 0;

  [[nodiscard]] hal::Microseconds now() const { return time_us; }
  hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) {
    if (sending == hal::Status::kOk) sent.push_back({frame, deadline_us});
    return sending;
  }
  std::size_t receive(std::span<hal::ReceivedFrame> into) {
    ++fetches;
    const std::size_t count = std::min(into.size(), waiting);
    waiting -= count;
    return count;
  }
  void drop_pending() {
    ++drops;
    sent.clear();
  }
  [[nodiscard]] hal::BusState state() const { return {.mode = mode}; }
};

template <std::size_t Joints>
class ScriptedDrives {
 public:
  static constexpr std::size_t kJoints = Joints;
  static constexpr std::size_t kMaxOutgoing = Joints;

  std::array<hal::JointFeedback, Joints> joints;
  std::vector<hal::Status> answers;  // to the frames that come; kOk after the last
  std::size_t taken = 0;
  bool stop = false;
  hal::Microseconds max_age_us = 3000;
  mutable hal::Microseconds asked_at_us = 0;
  std::array<hal::TorqueCommand, Joints> commands;
  hal::Heartbeat heartbeat;
  static constexpr std::uint32_t kReportId = 0x73F;
  std::vector<hal::Diagnosis> reports;
  static constexpr std::uint32_t kFaultId = 0x75F;
  std::vector<hal::FaultReport> faults;

  hal::Status take(const hal::ReceivedFrame& /*frame*/) {
    return taken < answers.size() ? answers[taken++] : (++taken, hal::Status::kOk);
  }
  [[nodiscard]] hal::JointFeedback feedback(std::size_t joint, hal::Microseconds now_us) const {
    asked_at_us = now_us;
    return joints[joint];
  }
  std::size_t outgoing(std::span<const hal::TorqueCommand> of_joints, const hal::Heartbeat& beat,
                       std::span<hal::Frame> into) {
    std::copy(of_joints.begin(), of_joints.end(), commands.begin());
    heartbeat = beat;
    for (std::size_t j = 0; j < Joints; ++j) into[j].id = static_cast<std::uint32_t>(0x100 + j);
    return Joints;
  }
  bool report(const hal::Diagnosis& found, hal::Frame& into) {
    reports.push_back(found);
    into.id = kReportId;
    return true;
  }
  bool report(const hal::FaultReport& fault, hal::Frame& into) {
    faults.push_back(fault);
    into.id = kFaultId;
    return true;
  }
  [[nodiscard]] hal::Microseconds drive_max_age_us() const { return max_age_us; }
  [[nodiscard]] bool stop_seen() const { return stop; }
  void clear_stop() { stop = false; }
  [[nodiscard]] hal::DriveCounts counts() const { return {}; }
};

// Two slides at right angles without weight: of the first one the drive moves 5 kg, of the second
// 3 kg, and neither feels the other. They stand where the test puts them; drives are in the mode
// that they were told, and say that they give the torque that they were told.
template <typename Space>
class ScriptedJointsIn {
 public:
  static constexpr std::size_t kJoints = 2;
  static constexpr hal::Microseconds kPeriodUs = 1000;
  static constexpr std::array<double, kJoints> kMass{5, 3};
  static constexpr double kMaxTorque = 10;
  static constexpr double kKp = 100;
  static constexpr double kKd = 20;
  using Controller = controller::JointController<2, 4, double, WithoutMemory, Space>;
  using Config = typename Controller::Config;
  using Drives = ScriptedDrives<kJoints>;
  using Vector2 = Vector<2, double>;

  explicit ScriptedJointsIn(const Config& config = default_config()) {
    if (Controller::create(config, controller) != Status::kOk) throw std::logic_error("refused");
  }

  static Config default_config() {
    MonitorConfig<2, double, Space> monitor;
    monitor.chain.gravity_m_s2 = {0, 0, 0};
    monitor.chain.joints[0].axis = {1, 0, 0};
    monitor.chain.joints[1].axis = {0, 1, 0};
    monitor.chain.joints[0].mass_kg = kMass[0] - kMass[1];
    monitor.chain.joints[1].mass_kg = kMass[1];
    for (auto& joint : monitor.chain.joints) {
      joint.type = JointType::kPrismatic;
      joint.max_torque = kMaxTorque;
    }
    monitor.estimator.hidden_units = 4;
    monitor.estimator.learning_rate = 0;
    // Nothing is a fault of the arm.
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      for (auto& joint : monitor.bound.joints) joint.value[0] = 1000;
    } else {
      monitor.bound.offset = 1000;
    }
    ComputedTorqueGains<2, double> gains;
    gains.kp.fill(kKp);
    gains.kd.fill(kKd);
    auto config = controller::controller_config(monitor, gains);
    config.arming.position_window.fill(1);
    config.arming.speed.fill(1);
    config.arming.torque_rate.fill(kMaxTorque / monitor.estimator.period_s);
    return config;
  }

  void tick(std::uint32_t late_ticks = 0) {
    bus.time_us += kPeriodUs * (1 + late_ticks);
    for (std::size_t j = 0; j < kJoints; ++j) {
      hal::JointFeedback& joint = drives.joints[j];
      if (reads[j]) joint.encoder_time_us = bus.time_us;
      if (follows[j]) joint.status.mode = drives.commands[j].mode;
      if (follows[j]) joint.status.applied_torque = drives.commands[j].torque;
    }
    controller.step(bus.time_us, late_ticks, reference_at, bus, drives, *data);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  // Heard, passive, armed and followed.
  [[nodiscard]] bool start() {
    become_passive();
    if (!arm()) return false;
    run(3);
    return data->state == hal::ControllerState::kArmed && data->drives_follow;
  }
  void become_passive() {
    be_heard();
    tick();
  }
  void be_heard() {
    for (hal::JointFeedback& joint : drives.joints) {
      joint.encoder = hal::SourceState::kValid;
      joint.drive = hal::SourceState::kValid;
      joint.reading.has_velocity = true;
    }
  }
  [[nodiscard]] bool arm() { return try_to_arm() == controller::Fault::kNone; }
  [[nodiscard]] controller::Fault try_to_arm() { return controller.arm(reference_at, *data); }
  [[nodiscard]] bool disarm() { return controller.disarm(*data); }
  [[nodiscard]] bool clear_fault() { return controller.clear_fault(drives, *data); }
  void stop(controller::Fault reason) { controller.stop(reason, bus, *data); }

  [[nodiscard]] hal::ControllerState state() const { return data->state; }
  [[nodiscard]] controller::Fault fault() const { return data->fault; }
  [[nodiscard]] bool all_commanded(hal::DriveMode mode) const {
    return std::all_of(drives.commands.begin(), drives.commands.end(),
                       [mode](const hal::TorqueCommand& command) { return command.mode == mode; });
  }

  ScriptedBus bus;
  ScriptedDrives<kJoints> drives;
  std::array<bool, kJoints> reads{true, true};    // a new reading every tick
  std::array<bool, kJoints> follows{true, true};  // the drive does what it is told
  std::function<Reference<2, double>(double)> reference_at = [](double) {
    return Reference<2, double>{};
  };
  Controller controller;
  std::unique_ptr<typename Controller::Data> data = std::make_unique<typename Controller::Data>();
};

using ScriptedJoints = ScriptedJointsIn<AccelerationSpace>;

}  // namespace offnominal::test
