#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/controller/fault.hpp>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <offnominal/hal/bus.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/monitor.hpp>
#include <span>

// The joint controller, one tick at a time: receive, judge, watch, command. The same code runs in a
// unit test, in software-in-the-loop, on Linux and on a microcontroller: what differs is the bus,
// the drives' protocol and who calls step(). It knows no clock of its own.

namespace offnominal::controller {

using hal::ControllerState;

// Plain data, ready to be logged.
template <int N, int L, typename Scalar, typename Memory = WithoutMemory>
struct ControllerData {
  ControllerState state = ControllerState::kInit;
  Fault fault = Fault::kNone;
  std::uint32_t ticks = 0;           // since the start
  std::uint32_t run_ticks = 0;       // since arming
  std::uint32_t overruns = 0;        // ticks that began late, ever
  std::uint32_t missed_samples = 0;  // ticks without a fresh reading of every joint, ever
  std::uint32_t refused_frames = 0;  // that came with something wrong in them, ever
  std::uint32_t unsent_frames = 0;   // that the bus did not take, ever
  std::uint8_t late_in_a_row = 0;
  std::array<Microseconds, static_cast<std::size_t>(N)> used_time_us{};  // of the last sample
  JointSample<N, Scalar> sample;
  std::array<VelocityObserverState<Scalar>, static_cast<std::size_t>(N)> velocity{};
  std::array<hal::TorqueCommand, static_cast<std::size_t>(N)> commands{};
  MonitorState<N, L, Scalar, Memory> monitor;
  MonitorOutput<N, Scalar> output;
  bool fresh = false;              // this tick had a sample of its own
  std::uint32_t unseen_ticks = 0;  // periods without one, since the monitor saw the last
};

// Memory: as of the Monitor.
template <int N, int L, typename Scalar, typename Memory = WithoutMemory>
class JointController {
 public:
  using Config = ControllerConfig<N, Scalar>;
  using Data = ControllerData<N, L, Scalar, Memory>;
  using Watch = Monitor<N, L, Scalar, Memory>;

  // As Monitor::create().
  [[nodiscard]] static Status create(const Config& config, JointController& controller) {
    if (const Status status = validate(config); status != Status::kOk) return status;
    const Status status = Watch::create(config.monitor, controller.monitor_);
    if (status != Status::kOk) return status;
    controller.config_ = config;
    controller.config_.velocity_observer = observer_of(config);
    return Status::kOk;
  }

  // One tick that began at `begin_us` on the bus's clock. reference_at(time_s): where the joints
  // should be, Reference<N, Scalar>, so long after arming. late_ticks: whole periods that this tick
  // began too late; they are counted and the reference goes on without them.
  template <hal::Bus Bus, hal::DriveProtocol Drives, typename ReferenceAt>
  void step(Microseconds begin_us, std::uint32_t late_ticks, const ReferenceAt& reference_at,
            Bus& bus, Drives& drives, Data& data) const {
    static_assert(Drives::kJoints == kJoints);
    ++data.ticks;
    receive(bus, drives, data);
    count_late(late_ticks, data);
    if (is_running(data)) data.run_ticks += 1 + late_ticks;
    take_feedback(begin_us, bus, drives, data);
    data.unseen_ticks += late_ticks + (data.fresh ? 0 : 1);
    if (data.fresh) watch(reference_at, bus, data);
    command(reference_at, data);
    send(begin_us, bus, drives, data);
  }

  // kPassive -> kArmed: with the next fresh sample of every joint the monitor starts anew and time
  // counts from 0. False, and nothing changed, in any other state.
  [[nodiscard]] bool arm(Data& data) const {
    if (data.state != ControllerState::kPassive) return false;
    data.state = ControllerState::kArmed;
    data.run_ticks = 0;
    data.monitor.initialised = false;
    return true;
  }

  // kArmed -> kPassive: the commands of the next tick are "off". False, and nothing changed, in any
  // other state.
  [[nodiscard]] bool disarm(Data& data) const {
    if (data.state != ControllerState::kArmed) return false;
    data.state = ControllerState::kPassive;
    data.monitor.initialised = false;
    return true;
  }

  // kFault -> kInit: from there it takes fresh frames of every joint to become passive, and arm()
  // to command torque again. Whoever calls it says that the cause is gone. False in other states.
  template <hal::DriveProtocol Drives>
  [[nodiscard]] bool clear_fault(Drives& drives, Data& data) const {
    if (data.state != ControllerState::kFault) return false;
    drives.clear_stop();
    data.state = ControllerState::kInit;
    data.fault = Fault::kNone;
    data.late_in_a_row = 0;
    return true;
  }

  // To the safe state, latched. Its commands go out with the next tick; nothing older does.
  template <hal::Bus Bus>
  void stop(Fault reason, Bus& bus, Data& data) const {
    enter_fault(reason, bus, data);
  }

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const Watch& monitor() const { return monitor_; }

 private:
  static constexpr auto kJoints = static_cast<std::size_t>(N);
  using Feedback = std::array<hal::JointFeedback, kJoints>;

  // At most so many frames in one tick: a node that babbles must not keep the controller busy.
  static constexpr std::size_t kBatch = 4;
  static constexpr int kMostBatches = 64;

  // Armed, and the first sample has been there.
  static bool is_running(const Data& data) {
    return data.state == ControllerState::kArmed && data.monitor.initialised;
  }
  [[nodiscard]] Scalar run_time_s(const Data& data) const {
    return static_cast<Scalar>(data.run_ticks) * config_.monitor.estimator.period_s;
  }

  // Not what belongs to somebody else, and not the first records of a source, which are awaited.
  static bool is_wrong(hal::Status status) {
    return status != hal::Status::kOk && status != hal::Status::kUnknownId &&
           status != hal::Status::kNotSynchronised;
  }

  // Phases of a tick are not inlined: each gives its stack back before the next one begins.
  template <typename Bus, typename Drives>
  [[gnu::noinline]] static void receive(Bus& bus, Drives& drives, Data& data) {
    std::array<hal::ReceivedFrame, kBatch> frames;
    for (int batch = 0; batch < kMostBatches; ++batch) {
      const std::size_t count = bus.receive(frames);
      for (std::size_t i = 0; i < count; ++i) {
        const hal::Status status = drives.take(frames[i]);
        if (is_wrong(status)) ++data.refused_frames;
      }
      if (count < kBatch) return;
    }
  }

  // What all that came says of the joints at the tick's begin: state, fault and sample of it.
  template <typename Bus, typename Drives>
  [[gnu::noinline]] void take_feedback(Microseconds begin_us, Bus& bus, Drives& drives,
                                       Data& data) const {
    Feedback feedback;
    for (std::size_t j = 0; j < kJoints; ++j) feedback[j] = drives.feedback(j, begin_us);
    const Fault fault = judge(feedback, drives.stop_seen(), bus.state().mode, data);
    advance(fault, feedback, bus, data);
    take_sample(feedback, data);
  }

  static void count_late(std::uint32_t late_ticks, Data& data) {
    if (late_ticks == 0) {
      data.late_in_a_row = 0;
      return;
    }
    ++data.overruns;
    if (data.late_in_a_row < 255) ++data.late_in_a_row;
  }

  [[nodiscard]] Fault judge(const Feedback& feedback, bool stop_seen, hal::BusMode mode,
                            const Data& data) const {
    if (mode == hal::BusMode::kOff || mode == hal::BusMode::kDown) return Fault::kBusLost;
    if (stop_seen) return Fault::kEmergencyStop;
    if (data.late_in_a_row > config_.late_ticks_allowed) return Fault::kOverrun;
    for (const hal::JointFeedback& joint : feedback) {
      if (joint.encoder == hal::SourceState::kStale) return Fault::kEncoderSilent;
      if (joint.encoder == hal::SourceState::kError) return Fault::kEncoderUntrusted;
      if (joint.drive == hal::SourceState::kStale) return Fault::kDriveSilent;
      if (joint.drive == hal::SourceState::kError) return Fault::kDriveUntrusted;
      if ((joint.status.flags & (hal::kDriveFault | hal::kEncoderFault)) != 0) {
        return Fault::kDriveReported;
      }
      const bool has_to_follow = is_running(data) && data.run_ticks > config_.ticks_to_follow;
      if (has_to_follow && joint.status.mode != hal::DriveMode::kTorque) {
        return Fault::kDriveNotFollowing;
      }
    }
    return Fault::kNone;
  }

  static bool all_valid(const Feedback& feedback) {
    return std::all_of(feedback.begin(), feedback.end(), [](const hal::JointFeedback& joint) {
      return joint.encoder == hal::SourceState::kValid && joint.drive == hal::SourceState::kValid;
    });
  }

  template <typename Bus>
  void advance(Fault fault, const Feedback& feedback, Bus& bus, Data& data) const {
    const bool has_left_init =
        data.state == ControllerState::kPassive || data.state == ControllerState::kArmed;
    if (fault != Fault::kNone) {
      // In kInit nothing moves yet: it stays there until all is well, but for a stop.
      if (has_left_init || fault == Fault::kEmergencyStop) enter_fault(fault, bus, data);
      return;
    }
    if (data.state == ControllerState::kInit && all_valid(feedback)) {
      data.state = ControllerState::kPassive;
      data.monitor.initialised = false;
    }
  }

  template <typename Bus>
  void enter_fault(Fault fault, Bus& bus, Data& data) const {
    if (data.state == ControllerState::kFault) return;
    data.state = ControllerState::kFault;
    data.fault = fault;
    data.commands.fill({config_.safe_mode, 0});
    bus.drop_pending();
  }

  // Fresh: every joint has been read since the last sample.
  void take_sample(const Feedback& feedback, Data& data) const {
    data.fresh = true;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const bool valid = feedback[j].encoder == hal::SourceState::kValid;
      const bool is_new = feedback[j].encoder_time_us != data.used_time_us[j];
      data.fresh = data.fresh && valid && is_new;
    }
    if (!data.fresh) {
      if (is_running(data)) ++data.missed_samples;
      for (auto& velocity : data.velocity) coast(config_.velocity_observer, velocity);
      return;
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      data.used_time_us[j] = feedback[j].encoder_time_us;
      data.sample.q[i] = static_cast<Scalar>(feedback[j].reading.position);
      data.sample.dq[i] = velocity_of(feedback[j].reading, data.velocity[j]);
      data.sample.tau[i] = static_cast<Scalar>(feedback[j].status.applied_torque);
    }
  }

  [[nodiscard]] Scalar velocity_of(const hal::EncoderReading& reading,
                                   VelocityObserverState<Scalar>& observer) const {
    if (reading.has_velocity) return static_cast<Scalar>(reading.velocity);
    // A position that a frame has carried is finite.
    static_cast<void>(
        update(config_.velocity_observer, static_cast<Scalar>(reading.position), observer));
    return observer.velocity;
  }

  template <typename ReferenceAt, typename Bus>
  [[gnu::noinline]] void watch(const ReferenceAt& reference_at, Bus& bus, Data& data) const {
    const bool armed = data.state == ControllerState::kArmed;
    const bool passive = data.state == ControllerState::kPassive && config_.watch_when_passive;
    if (!armed && !passive) return;
    const bool follows = data.monitor.initialised && data.unseen_ticks == 0;
    const Status status = follows ? monitor_.step(data.sample, data.monitor, data.output)
                                  : begin_watch(reference_at, armed, data);
    data.unseen_ticks = 0;
    if (status != Status::kOk) {
      enter_fault(fault_of(status), bus, data);
    } else if (config_.stop_at_detection && data.output.detector.latched) {
      enter_fault(Fault::kDetected, bus, data);
    }
  }

  // The first sample, or the first one after some that nobody saw.
  template <typename ReferenceAt>
  [[nodiscard, gnu::noinline]] Status begin_watch(const ReferenceAt& reference_at, bool armed,
                                                  Data& data) const {
    if (data.monitor.initialised) {
      return monitor_.resume(data.sample, data.unseen_ticks, data.monitor);
    }
    data.output = {};
    if constexpr (Watch::kRemembers) data.monitor.memory = {};  // of another run
    if (armed) take_wanted_torque(reference_at, data);
    return monitor_.reset(data.sample, data.monitor);
  }

  // From here on the drives give what is commanded now; a late one still gives what it was told.
  template <typename ReferenceAt>
  void take_wanted_torque(const ReferenceAt& reference_at, Data& data) const {
    if constexpr (Watch::kRemembers) {
      const Vector<N, Scalar> wanted = wanted_torque(reference_at, data);
      for (std::size_t j = 0; j < kJoints; ++j) {
        if (delay_of_joint(config_.monitor.chain, j) > 0) continue;
        data.sample.tau[static_cast<Eigen::Index>(j)] = wanted[static_cast<Eigen::Index>(j)];
      }
    } else {
      data.sample.tau = wanted_torque(reference_at, data);
    }
  }

  // Computed torque and compensation, held to what the joints' drives can give.
  template <typename ReferenceAt>
  [[nodiscard, gnu::noinline]] Vector<N, Scalar> wanted_torque(const ReferenceAt& reference_at,
                                                               const Data& data) const {
    const Scalar time_s = run_time_s(data);
    Vector<N, Scalar> tau =
        computed_torque<N, Scalar>(monitor_.model(), config_.gains, reference_at(time_s),
                                   data.sample.q, data.sample.dq, time_s) +
        data.output.compensation.torque;
    if constexpr (Watch::kRemembers) tau += data.monitor.memory.remembered;
    for (Eigen::Index i = 0; i < N; ++i) {
      const Scalar limit = config_.monitor.chain.joints[static_cast<std::size_t>(i)].max_torque;
      tau[i] = std::clamp(tau[i], -limit, limit);
    }
    return tau;
  }

  template <typename ReferenceAt>
  [[gnu::noinline]] void command(const ReferenceAt& reference_at, Data& data) const {
    if (data.state == ControllerState::kFault) return;
    if (!is_running(data)) {
      data.commands.fill({});
    } else if (data.fresh) {
      const Vector<N, Scalar> tau = wanted_torque(reference_at, data);
      for (std::size_t j = 0; j < kJoints; ++j) {
        data.commands[j] = {hal::DriveMode::kTorque,
                            static_cast<float>(tau[static_cast<Eigen::Index>(j)])};
      }
    }  // else: the last torque is held until a sample comes or its source is stale
  }

  template <typename Bus, typename Drives>
  [[gnu::noinline]] void send(Microseconds begin_us, Bus& bus, Drives& drives, Data& data) const {
    std::array<hal::Frame, Drives::kMaxOutgoing> frames;
    const hal::Heartbeat heartbeat{data.state, static_cast<std::uint8_t>(data.fault), data.ticks};
    const std::size_t count = drives.outgoing(data.commands, heartbeat, frames);
    for (std::size_t i = 0; i < count; ++i) {
      const hal::Status status = bus.send(frames[i], begin_us + config_.command_lifetime_us);
      if (status != hal::Status::kOk) ++data.unsent_frames;
    }
  }

  Config config_{};
  Watch monitor_;
};

}  // namespace offnominal::controller
