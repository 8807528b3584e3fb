// One joint that lies on a desk, with a drive that says what a test wants it to.
#pragma once

#include <functional>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>

namespace offnominal::test {

// A bus on which nothing happens but time.
struct SilentBus {
  hal::Microseconds time_us = 0;
  hal::BusState bus_state;
  int dropped = 0;

  [[nodiscard]] hal::Microseconds now() const { return time_us; }
  hal::Status send(const hal::Frame& /*frame*/, hal::Microseconds /*deadline_us*/) {
    return hal::Status::kOk;
  }
  std::size_t receive(std::span<hal::ReceivedFrame> /*frames*/) { return 0; }
  void drop_pending() { ++dropped; }
  [[nodiscard]] hal::BusState state() const { return bus_state; }
};

// A protocol without frames.
struct OneDrive {
  static constexpr std::size_t kJoints = 1;
  static constexpr std::size_t kMaxOutgoing = 1;
  hal::JointFeedback joint;
  hal::TorqueCommand command;
  hal::Heartbeat heartbeat;

  hal::Status take(const hal::ReceivedFrame& /*frame*/) { return hal::Status::kOk; }
  [[nodiscard]] hal::JointFeedback feedback(std::size_t /*j*/, hal::Microseconds /*now_us*/) const {
    return joint;
  }
  std::size_t outgoing(std::span<const hal::TorqueCommand> commands, const hal::Heartbeat& said,
                       std::span<hal::Frame> /*frames*/) {
    command = commands[0];
    heartbeat = said;
    return 0;
  }
  static bool report(const hal::Diagnosis& /*found*/, hal::Frame& /*into*/) { return false; }
  std::vector<hal::FaultReport> faults;
  bool report(const hal::FaultReport& fault, hal::Frame& /*into*/) {
    faults.push_back(fault);
    return false;
  }
  [[nodiscard]] static hal::Microseconds drive_max_age_us() { return 2500; }
  [[nodiscard]] bool stop_seen() const { return false; }
  void clear_stop() {}
  [[nodiscard]] hal::DriveCounts counts() const { return {}; }
};

// The joint turns about an upright axis, without friction: what moves it is its torque alone.
template <typename Space, typename Isolates = WithoutIsolation>
class JointOnDeskIn {
 public:
  using Controller = controller::JointController<1, 4, float, WithoutMemory, Space, Isolates>;
  using Config = typename Controller::Config;
  static constexpr double kInertia = 2;  // kg m^2
  static constexpr double kPeriod = 0.001;

  static Config config() {
    MonitorConfig<1, float, Space> monitor;
    monitor.chain.gravity_m_s2 = {0, 0, -9.81F};
    auto& joint = monitor.chain.joints[0];
    joint.mass_kg = static_cast<float>(kInertia);
    joint.centre_of_mass_m = {1, 0, 0};
    joint.max_torque = 100;
    monitor.torque_signal = TorqueSignal::kHeld;
    monitor.estimator.hidden_units = 4;
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      monitor.bound.joints[0].value[0] = static_cast<float>(5 * kInertia);
    } else {
      monitor.bound.kind = BoundKind::kConstant;
      monitor.bound.offset = 5;
    }
    ComputedTorqueGains<1, float> gains;
    gains.kp.fill(100);
    gains.kd.fill(20);
    return controller::controller_config(monitor, gains);
  }

  explicit JointOnDeskIn(const Config& config = JointOnDeskIn::config()) {
    if (Controller::create(config, controller) != Status::kOk) throw std::logic_error("refused");
  }

  // One period: the joint moves, is measured, and the controller has its tick.
  void tick(std::uint32_t late_ticks = 0) {
    for (std::uint32_t i = 0; i <= late_ticks; ++i) move();
    if (encoder_speaks) {
      drive.joint.encoder_time_us = bus.time_us;
      drive.joint.encoder = hal::SourceState::kValid;
      const float position = reading_of(q);
      drive.joint.reading = {lie.value_or(position), sends_velocity ? static_cast<float>(dq) : 0.0F,
                             sends_velocity};
    } else if (bus.time_us - drive.joint.encoder_time_us > max_silence_us) {
      drive.joint.encoder = hal::SourceState::kStale;
    }
    drive.joint.drive = hal::SourceState::kValid;
    drive.joint.status = {tells_mode ? drive.command.mode : hal::DriveMode::kOff, 0,
                          drive.command.torque};
    controller.step(bus.time_us, late_ticks, reference_at, bus, drive, *data);
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  controller::Fault arm() { return controller.arm(reference_at, *data); }
  // From cold to commanding torque, as soon as it may.
  controller::Fault start() {
    controller::Fault refusal = controller::Fault::kNotPassive;
    for (int i = 0; i < 100 && passes_by_itself(refusal); ++i) {
      tick();
      refusal = arm();
    }
    return refusal;
  }
  bool clear_fault() { return controller.clear_fault(drive, *data); }
  [[nodiscard]] float torque() const { return drive.command.torque; }
  [[nodiscard]] hal::DriveMode mode() const { return drive.command.mode; }

  double q = 0;        // rad
  double dq = 0;       // rad/s
  double push_nm = 0;  // beside the drive's torque, where that acts
  bool encoder_speaks = true;
  hal::Microseconds max_silence_us = 2500;
  bool sends_velocity = true;
  bool tells_mode = true;          // or says "off", whatever it does
  std::optional<double> brake_at;  // holds the joint there
  std::optional<float> lie;        // of the encoder
  std::function<float(double)> reading_of = [](double at) { return static_cast<float>(at); };
  std::function<Reference<1, float>(double)> reference_at = [](double) {
    return Reference<1, float>{};
  };
  SilentBus bus;
  OneDrive drive;
  Controller controller;
  std::unique_ptr<typename Controller::Data> data = std::make_unique<typename Controller::Data>();

 private:
  void move() {
    bus.time_us += 1000;
    if (drive.command.mode == hal::DriveMode::kTorque) {
      dq += kPeriod * (static_cast<double>(drive.command.torque) + push_nm) / kInertia;
    }
    q += kPeriod * dq;
    if (!brake_at) return;
    q = *brake_at;
    dq = 0;
  }
};

using JointOnDesk = JointOnDeskIn<AccelerationSpace>;

// A reference of one joint.
inline Reference<1, float> at(float q, float dq = 0, float ddq = 0) {
  Reference<1, float> reference;
  reference.q[0] = q;
  reference.dq[0] = dq;
  reference.ddq[0] = ddq;
  return reference;
}

}  // namespace offnominal::test
