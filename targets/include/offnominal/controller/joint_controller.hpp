#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/control/reference_ramp.hpp>
#include <offnominal/control/slow_down.hpp>
#include <offnominal/controller/arming_check.hpp>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/controller/controller_data.hpp>
#include <offnominal/controller/diagnosis_of.hpp>
#include <offnominal/controller/fault.hpp>
#include <offnominal/controller/feedback_check.hpp>
#include <offnominal/controller/sample_taker.hpp>
#include <offnominal/controller/takeover.hpp>
#include <offnominal/controller/torque_limiter.hpp>
#include <offnominal/diagnosis/isolation_choice.hpp>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/monitor.hpp>
#include <span>
#include <type_traits>

// The joint controller, one tick at a time: receive, judge, watch, command. The same code runs in a
// unit test, in software-in-the-loop, on Linux and on a microcontroller: what differs is the bus,
// the drives' protocol and who calls step(). It knows no clock of its own.

namespace offnominal::controller {

// Memory, Space: as of the Monitor. In TorqueSpace the bus is told which joint is off nominal
// (hal::Diagnosis), and WithIsolation, from the first answer after a detection on, which fault it
// is (hal::FaultReport).
template <int N, int L, typename Scalar, typename Memory = WithoutMemory,
          typename Space = AccelerationSpace, typename Isolates = WithoutIsolation>
class JointController {
 public:
  using Config = ControllerConfig<N, Scalar, Space>;
  using Data = ControllerData<N, L, Scalar, Memory, Space, Isolates>;
  using Watch = Monitor<N, L, Scalar, Memory, Space>;

  // As Monitor::create().
  [[nodiscard]] static Status create(const Config& config, JointController& controller) {
    if (const Status status = validate(config); status != Status::kOk) return status;
    Status status = Watch::create(config.monitor, controller.monitor_);
    if (status != Status::kOk) return status;
    if constexpr (kIsolates) {
      status = IsolationOf::create({}, config.monitor, controller.isolation_);
      if (status != Status::kOk) return status;
    }
    controller.config_ = static_cast<const ControlConfig<N, Scalar>&>(config);
    controller.samples_ = SampleTaker<N, Scalar>(config);
    controller.takeover_ = Takeover<N, Scalar>(config);
    controller.limiter_ = TorqueLimiter<N, Scalar>(config);
    return Status::kOk;
  }

  // One tick that began at `begin_us` on the bus's clock. reference_at(time_s): where the joints
  // should be, Reference<N, Scalar>, so long after arming, less what a motion that was slowed is
  // behind; a double, which tells ticks apart for longer than any run. late_ticks: whole periods
  // that this tick began too late; they are counted and the reference goes on without them.
  template <hal::Bus Bus, hal::DriveProtocol Drives, typename ReferenceAt>
  void step(Microseconds begin_us, std::uint32_t late_ticks, const ReferenceAt& reference_at,
            Bus& bus, Drives& drives, Data& data) const {
    static_assert(Drives::kJoints == static_cast<std::size_t>(N));
    if constexpr (N == kRuntimeJoints) {
      if (data.commands.size() != joints()) size_data(data);
    }
    ++data.ticks;
    receive(bus, drives, data);
    count_late(late_ticks, data);
    samples_.leave_out(late_ticks, data);
    take_feedback(begin_us, bus, drives, data);
    if (data.state == ControllerState::kArmed) {
      (data.drives_follow ? data.run_ticks : data.waiting_ticks) += std::uint64_t{late_ticks} + 1;
    }
    if (data.fresh) {
      watch(reference_at, bus, data);
      data.unseen_ticks = 0;
    }
    command(reference_at, bus, data);
    send(begin_us, bus, drives, data);
  }

  // kPassive -> kArmed: from the next fresh sample of every joint on the arm is held where it was
  // in that sample; what it moved then fades out. When the torque that this takes is in, every
  // drive says that it is in torque mode, and no joint is faster than it may be at arming, time
  // begins to count and the monitor to watch. An arm that leaves its window before, or takes too
  // long, is kArmNotHeld. kNone, or why nothing changed: the state is another, there is no sample
  // or no settled velocity, gains or torque limits are missing, or reference_at(0) is no way to
  // begin from where the arm is. What changes until that sample is judged again there, and is then
  // a fault.
  template <typename ReferenceAt>
  [[nodiscard]] Fault arm(const ReferenceAt& reference_at, Data& data) const {
    if (data.state != ControllerState::kPassive) return Fault::kNotPassive;
    if (!data.fresh) return Fault::kNoFreshSample;
    if (!samples_.is_settled(data)) return Fault::kVelocityUnsettled;
    const Fault refusal = check_beginning(reference_at(0.0), data);
    if (refusal != Fault::kNone) return refusal;
    takeover_.reset(data);
    data.state = ControllerState::kArmed;
    data.run_ticks = 0;
    data.slows = false;
    data.ends = false;
    data.commands.fill({});  // whatever was told before: the torque rises from 0
    return Fault::kNone;
  }

  // kArmed -> kPassive: the commands of the next tick are "off". False, and nothing changed, in any
  // other state.
  [[nodiscard]] bool disarm(Data& data) const {
    if (data.state != ControllerState::kArmed) return false;
    data.state = ControllerState::kPassive;
    data.commands.fill({});
    data.monitor.initialised = false;
    return true;
  }

  // For the end of a program, in every state: nobody looks after the drives from now on, and all
  // that they are told is "off". In a fault too, whatever its safe mode. Until arm().
  void let_go(Data& data) const {
    static_cast<void>(disarm(data));
    data.ends = true;
    data.commands.fill({});
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
    samples_.forget(data);
    return true;
  }

  // To the safe state, latched. Its commands go out with the next tick; nothing older does.
  template <hal::Bus Bus>
  void stop(Fault reason, Bus& bus, Data& data) const {
    enter_fault(reason, bus, data);
  }

  // What of output.compensation is added to the computed torque, N m or N, before both are held to
  // what the drives can give: nothing unless armed, or before a fault is named that is compensated.
  [[nodiscard]] Vector<N, Scalar> acting_compensation(const Data& data) const {
    const bool acts = data.state == ControllerState::kArmed && compensates(data);
    return acts ? data.output.compensation.torque
                : Vector<N, Scalar>(zeros<N, Scalar>(static_cast<Eigen::Index>(joints())));
  }

  // How the time of the reference runs in this tick, beside the run's own.
  [[nodiscard]] Pace<Scalar> pace(const Data& data) const {
    return data.slows ? pace_of(config_.slow_down, seconds(data.run_ticks - data.slow_since))
                      : Pace<Scalar>{};
  }

  // Armed, and what is judged is still of a time in which something else may have held the arm: of
  // observed velocities, positions and torques, for as long as these settle. The watch begins anew
  // with every sample until then.
  [[nodiscard]] bool is_settling(const Data& data) const {
    return data.observes && data.state == ControllerState::kArmed && data.drives_follow &&
           !samples_.has_forgotten(data.run_ticks);
  }

  // The monitor has its own: monitor().config().
  [[nodiscard]] const ControlConfig<N, Scalar>& config() const { return config_; }
  [[nodiscard]] const Watch& monitor() const { return monitor_; }

 private:
  using Feedback = typename SampleTaker<N, Scalar>::Feedback;
  static constexpr bool kByJoint = std::is_same_v<Space, TorqueSpace>;
  using IsolationOf = typename Isolates::template Of<N, Scalar>;
  static constexpr bool kIsolates = std::is_same_v<Isolates, WithIsolation>;
  static_assert(kByJoint || !kIsolates, "which fault it is only a monitor in TorqueSpace can say");

  // At most so many frames in one tick: a node that babbles must not keep the controller busy.
  static constexpr std::size_t kBatch = 4;
  static constexpr int kMostBatches = 64;
  // As many ticks as a silent encoder is borne.
  static constexpr std::uint8_t kImplausibleAllowed = 2;
  // Beside the heartbeat's tick, and the diagnosis' in the middle between two.
  static constexpr std::uint32_t kTurnOfFault = 7;

  [[nodiscard]] const Chain<N, Scalar>& chain() const { return monitor_.config().chain; }
  [[nodiscard]] std::size_t joints() const { return chain().joints.size(); }
  // Before the first tick, where the compiler does not know how many joints there are.
  void size_data(Data& data) const {
    size_for(joints(), data.sample.q, data.sample.dq, data.sample.tau, data.implausible_time_us,
             data.used_time_us, data.motion, data.turns, data.commands, data.observed.q,
             data.observed.dq, data.observed.tau);
    takeover_.reset(data);
    forget_output(data);
  }
  void forget_output(Data& data) const {
    data.output = {};
    size_for(joints(), data.output.error, data.output.psi_hat, data.output.compensation.torque);
    if constexpr (kByJoint) {
      size_for(joints(), data.output.thresholds, data.output.fast_error,
               data.output.fast_thresholds, data.output.detector.joints);
    }
  }

  // Armed, and time has begun.
  static bool is_running(const Data& data) {
    return data.state == ControllerState::kArmed && data.drives_follow;
  }
  [[nodiscard]] double seconds(std::uint64_t ticks) const {
    return static_cast<double>(ticks) * static_cast<double>(monitor_.config().estimator.period_s);
  }
  [[nodiscard]] double run_time_s(const Data& data) const { return seconds(data.run_ticks); }

  // Phases of a tick are not inlined: each gives its stack back before the next one begins.
  template <typename Bus, typename Drives>
  [[gnu::noinline]] static void receive(Bus& bus, Drives& drives, Data& data) {
    std::array<hal::ReceivedFrame, kBatch> frames;
    for (int batch = 0; batch < kMostBatches; ++batch) {
      const std::size_t count = bus.receive(frames);
      const Microseconds now_us = bus.now();
      for (std::size_t i = 0; i < count; ++i) {
        // Nothing has come later than now: a stamp that says so must not keep a source alive.
        frames[i].time_us = std::min(frames[i].time_us, now_us);
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
    size_for(joints(), feedback);
    for (std::size_t j = 0; j < feedback.size(); ++j) feedback[j] = drives.feedback(j, begin_us);
    samples_.screen(feedback, data);
    Fault fault = judge(feedback, drives.stop_seen(), bus.state().mode, data);
    const bool in_torque_mode = all_in_torque_mode<N>(feedback);
    if (fault == Fault::kNone && data.state == ControllerState::kArmed) {
      fault = takeover_.judge(in_torque_mode, drives.drive_max_age_us(), data);
    }
    advance(fault, feedback, bus, data);
    samples_.take(feedback, data);
    if (!data.fresh && is_running(data)) ++data.missed_samples;
    if (data.state != ControllerState::kArmed || data.drives_follow) return;
    // By a sample right after the one that the torque came in with.
    data.drives_follow =
        data.unseen_ticks == 0 && in_torque_mode && takeover_.is_over(data.sample, data);
  }

  static void count_late(std::uint32_t late_ticks, Data& data) {
    data.late_ticks = late_ticks;
    if (late_ticks == 0) {
      data.late_in_a_row = 0;
      return;
    }
    ++data.overruns;
    if (data.late_in_a_row < std::numeric_limits<std::uint16_t>::max()) ++data.late_in_a_row;
  }

  [[nodiscard]] Fault judge(const Feedback& feedback, bool stop_seen, hal::BusMode mode,
                            const Data& data) const {
    if (mode == hal::BusMode::kOff || mode == hal::BusMode::kDown) return Fault::kBusLost;
    if (stop_seen) return Fault::kEmergencyStop;
    const bool armed = data.state == ControllerState::kArmed;
    const bool too_late = armed && data.late_ticks > config_.late_ticks_allowed;
    if (too_late || data.late_in_a_row > config_.late_ticks_allowed) return Fault::kOverrun;
    const Fault fault = check_feedback<N>(feedback);
    const bool implausible = data.implausible_in_a_row > kImplausibleAllowed;
    return fault == Fault::kNone && implausible ? fault_of(data.implausible) : fault;
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
    const bool well = all_valid<N>(feedback) && data.implausible == Status::kOk;
    if (data.state == ControllerState::kInit && well) {
      data.state = ControllerState::kPassive;
      data.monitor.initialised = false;
    }
  }

  template <typename Bus>
  void enter_fault(Fault fault, Bus& bus, Data& data) const {
    if (data.state == ControllerState::kFault) return;
    data.state = ControllerState::kFault;
    data.fault = fault;
    data.commands.fill({data.ends ? hal::DriveMode::kOff : config_.safe_mode, 0});
    samples_.forget(data);
    bus.drop_pending();
  }

  template <typename ReferenceAt, typename Bus>
  [[gnu::noinline]] void watch(const ReferenceAt& reference_at, Bus& bus, Data& data) const {
    const bool armed = data.state == ControllerState::kArmed;
    const bool passive = data.state == ControllerState::kPassive && config_.watch_when_passive;
    if (!armed && !passive) return;
    joint_transforms(monitor_.model(), data.judged().q, data.transforms);
    if (!samples_.is_settled(data)) {
      data.monitor.initialised = false;
      if (armed) enter_fault(Fault::kVelocityUnknown, bus, data);
      return;
    }
    // Until every drive follows nobody knows which torque acts, and until it is what is wanted,
    // brakes or whatever else held the arm still do: the watch begins with each sample anew.
    if (armed && !data.drives_follow) data.monitor.initialised = false;
    const bool follows = data.monitor.initialised && data.unseen_ticks == 0 && !is_settling(data);
    const bool has_acted = data.output.detector.acts;
    const Fault fault =
        follows ? fault_of(monitor_.step(data.judged(), data.transforms, data.monitor, data.output))
                : begin_watch(reference_at, armed, data);
    if (follows && fault == Fault::kNone) isolate(data);
    if (fault != Fault::kNone) {
      enter_fault(fault, bus, data);
      return;
    }
    if (!data.output.detector.acts) return;
    if (!has_acted) data.act_tick = data.ticks;
    act(bus, data);
  }

  // Beyond the second level. The monitor goes on: it judges torque and motion as they are, and
  // knows nothing of a reference.
  template <typename Bus>
  void act(Bus& bus, Data& data) const {
    if (config_.at_detection == AtDetection::kStop) {
      enter_fault(Fault::kDetected, bus, data);
    } else if (config_.at_detection == AtDetection::kSlow && is_running(data) && !data.slows) {
      data.slows = true;
      data.slow_since = data.run_ticks;
    }
  }

  [[gnu::noinline]] void isolate(Data& data) const {
    if constexpr (kIsolates) {
      if (!config_.isolates) return;
      isolation_.step(monitor_.model(), data.judged(), data.sample.q, data.transforms,
                      data.monitor.tick, data.output, data.isolation);
      const auto& law = data.isolation.law;
      if (law.known) data.output.compensation = monitor_.compensation_of(law.load, data.output);
    }
  }

  // Whether output.compensation is to be given by the drives.
  [[nodiscard]] bool compensates(const Data& data) const {
    if constexpr (kIsolates) {
      const auto& found = data.isolation.diagnosis;
      return !config_.isolates || (found.decided && is_compensated(found.kind));
    }
    return true;
  }

  // The run's time goes on.
  [[nodiscard]] Status begin_again(Data& data) const {
    const std::uint64_t tick = data.monitor.tick;
    const Status status = monitor_.reset(data.judged(), data.transforms, data.monitor);
    if (status != Status::kOk) return status;
    data.monitor.tick = tick;
    return monitor_.resume(data.judged(), data.transforms, data.unseen_ticks, data.monitor);
  }

  // The first sample, or the first one after some that nobody saw.
  template <typename ReferenceAt>
  [[nodiscard, gnu::noinline]] Fault begin_watch(const ReferenceAt& reference_at, bool armed,
                                                 Data& data) const {
    if (data.monitor.initialised) {
      if (is_settling(data)) return fault_of(begin_again(data));
      return fault_of(
          monitor_.resume(data.judged(), data.transforms, data.unseen_ticks, data.monitor));
    }
    forget_output(data);
    if constexpr (Watch::kRemembers) {
      data.monitor.memory = {};  // of another run
      size_for(joints(), data.monitor.memory.remembered);
    }
    if constexpr (kIsolates) isolation_.reset(data.isolation);
    if (armed) {
      const Fault fault = begin_control(reference_at, data);
      if (fault != Fault::kNone) return fault;
      if (data.observes) joint_transforms(monitor_.model(), data.judged().q, data.transforms);
    }
    return fault_of(monitor_.reset(data.judged(), data.transforms, data.monitor));
  }

  [[nodiscard]] Fault check_beginning(const Reference<N, Scalar>& reference,
                                      const Data& data) const {
    const Fault fault = check_reference(reference, chain(), samples_.range());
    return fault == Fault::kNone ? check_arming(config_, chain(), data.sample, reference) : fault;
  }

  // From here on the drives give what is commanded now; a late one still gives what it was told.
  template <typename ReferenceAt>
  [[nodiscard]] Fault begin_control(const ReferenceAt& reference_at, Data& data) const {
    const Reference<N, Scalar> reference = reference_at(0.0);
    // Later samples are of an arm that may be held already, by some of its drives or by all.
    Fault fault = data.holds ? check_reference(reference, chain(), samples_.range())
                             : check_beginning(reference, data);
    if (fault == Fault::kNone) fault = takeover_.hold(data.sample, reference, data);
    if (fault != Fault::kNone) return fault;
    Vector<N, Scalar> wanted = zeros<N, Scalar>(static_cast<Eigen::Index>(joints()));
    const Fault refusal = want_torque(reference_at, data, wanted);
    if constexpr (Watch::kRemembers) {
      for (std::size_t j = 0; j < joints(); ++j) {
        if (delay_of_joint(chain(), j) > 0) continue;
        data.sample.tau[static_cast<Eigen::Index>(j)] = wanted[static_cast<Eigen::Index>(j)];
      }
    } else {
      data.sample.tau = wanted;
    }
    return refusal;
  }

  // Computed torque and compensation, held to what the joints' drives can give and to how fast it
  // may change. Otherwise why there is no such torque, `tau` is then not to be used.
  template <typename ReferenceAt>
  [[nodiscard, gnu::noinline]] Fault want_torque(const ReferenceAt& reference_at, Data& data,
                                                 Vector<N, Scalar>& tau) const {
    const double time_s = run_time_s(data);
    Reference<N, Scalar> reference;
    if (data.drives_follow) {
      const Pace<Scalar> of_time = pace(data);
      reference = reference_at(time_s - of_time.behind_s);
      const Fault fault = check_reference(reference, chain(), samples_.range());
      if (fault != Fault::kNone) return fault;
      if (data.slows) slow_down(of_time, reference);
      ramp_in(data.ramp, time_s, config_.arming.ramp_s, reference);
    } else {
      reference = takeover_.held(data);
    }
    // Those of what is judged are of an arm a little earlier.
    if (data.observes) joint_transforms(monitor_.model(), data.sample.q, data.transforms);
    tau = computed_torque<N, Scalar>(monitor_.model(), data.transforms, config_.gains, reference,
                                     data.sample.q, data.sample.dq, time_s);
    if (compensates(data)) tau += data.output.compensation.torque;
    if constexpr (Watch::kRemembers) tau += data.monitor.memory.remembered;
    if (!all_finite(tau)) return fault_of(Status::kNumericOverflow);
    limiter_.hold(data.commands, tau, data.torque_is_in);
    return Fault::kNone;
  }

  template <typename ReferenceAt, typename Bus>
  [[gnu::noinline]] void command(const ReferenceAt& reference_at, Bus& bus, Data& data) const {
    if (data.state == ControllerState::kFault) return;
    if (data.state != ControllerState::kArmed) {
      data.commands.fill({});
    } else if (data.fresh) {
      Vector<N, Scalar> tau;
      const Fault fault = want_torque(reference_at, data, tau);
      if (fault != Fault::kNone) {
        enter_fault(fault, bus, data);
        return;
      }
      for (std::size_t j = 0; j < data.commands.size(); ++j) {
        data.commands[j] = {hal::DriveMode::kTorque,
                            static_cast<float>(tau[static_cast<Eigen::Index>(j)])};
      }
    }  // else: the last torque is held until a sample comes or its source is stale
  }

  template <typename Bus, typename Drives>
  [[gnu::noinline]] void send(Microseconds begin_us, Bus& bus, Drives& drives, Data& data) const {
    std::array<hal::Frame, Drives::kMaxOutgoing> frames;
    const hal::Heartbeat heartbeat{data.state, static_cast<std::uint8_t>(data.fault),
                                   static_cast<std::uint32_t>(data.ticks)};
    const std::size_t count = drives.outgoing(data.commands, heartbeat, frames);
    for (std::size_t i = 0; i < count; ++i) {
      const hal::Status status = bus.send(frames[i], begin_us + config_.command_lifetime_us);
      if (status != hal::Status::kOk) ++data.unsent_frames;
    }
    if constexpr (kByJoint) report(begin_us, bus, drives, data);
  }

  // Between two heartbeats, and at once in the tick that says it first: which joint is off nominal,
  // that it is beyond the second level too, and which fault it is.
  template <typename Bus, typename Drives>
  void report(Microseconds begin_us, Bus& bus, Drives& drives, Data& data) const {
    const DetectorState<Scalar>& detector = data.output.detector;
    const bool is_detected =
        detector.latched && data.fresh && detector.detection_tick == data.monitor.tick;
    const bool is_new = is_detected || data.act_tick == data.ticks;
    const bool due = data.ticks % hal::kHeartbeatTicks == hal::kHeartbeatTicks / 2;
    const bool watches =
        data.state == ControllerState::kArmed || data.state == ControllerState::kPassive;
    const bool judges = watches && data.monitor.initialised;
    if (due || is_new) tell(begin_us, diagnosis_of(data.output, judges), bus, drives, data);
    if constexpr (kIsolates) {
      const FaultDiagnosis<Scalar>& found = data.isolation.diagnosis;
      const bool is_there = data.isolation.triggered && found.time_s > 0;
      const bool is_decided = found.decided && data.fresh && found.time_s == data.output.time_s;
      const bool has_turn = data.ticks % hal::kHeartbeatTicks == kTurnOfFault;
      if (is_there && (has_turn || is_decided)) {
        tell(begin_us, fault_report_of(found), bus, drives, data);
      }
    }
  }
  template <typename Message, typename Bus, typename Drives>
  void tell(Microseconds begin_us, const Message& message, Bus& bus, Drives& drives,
            Data& data) const {
    hal::Frame frame;
    if (!drives.report(message, frame)) return;
    const hal::Status status = bus.send(frame, begin_us + config_.command_lifetime_us);
    if (status != hal::Status::kOk) ++data.unsent_frames;
  }

  ControlConfig<N, Scalar> config_{};
  Watch monitor_;
  [[no_unique_address]] IsolationOf isolation_{};
  SampleTaker<N, Scalar> samples_;
  Takeover<N, Scalar> takeover_;
  TorqueLimiter<N, Scalar> limiter_;
};

}  // namespace offnominal::controller
