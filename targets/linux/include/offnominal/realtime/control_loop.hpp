#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/realtime/cycle_timer.hpp>
#include <offnominal/realtime/recorder.hpp>
#include <string>
#include <type_traits>
#include <vector>

// The joint controller, tick by tick in real time: what the thread of a controller program runs.

namespace offnominal::realtime {

// What other threads may ask of the loop and see of it.
struct LoopPanel {
  std::atomic<bool> end{false};    // disarm, tell the drives, end
  std::atomic<bool> arm{false};    // kPassive -> kArmed; taken back when it was tried
  std::atomic<bool> clear{false};  // kFault -> kInit; the same
  std::atomic<hal::ControllerState> state{hal::ControllerState::kInit};
  std::atomic<controller::Fault> fault{controller::Fault::kNone};
  // Why it was not armed when it was last asked to; for whoever reads it to take back.
  std::atomic<controller::Fault> refusal{controller::Fault::kNone};
};

struct LoopConfig {
  // Once, as soon as every joint is heard. A refusal that does not pass by itself ends the loop:
  // nobody shall find the arm armed later, when it has come to lie right. A fault before, or
  // somebody who clears one, is the end of the wish: from then on it is armed only when that is
  // asked for.
  bool arm_when_passive = false;
  // Ends so long after it was first armed, or without arm_when_passive after the start; 0: never.
  Microseconds duration_us = 0;
  bool end_at_fault = false;  // 100 ms after it
};

// Plain data.
struct LoopReport {
  hal::ControllerState state = hal::ControllerState::kInit;  // before the clean stop
  controller::Fault fault = controller::Fault::kNone;        // the first
  controller::Fault refusal = controller::Fault::kNone;      // of arm_when_passive, for good
  std::uint64_t ticks = 0;
  std::uint32_t overruns = 0;      // ticks that began a period or more too late
  std::uint32_t left_out = 0;      // ticks that they cost
  Microseconds worst_late_us = 0;  // begin of a tick after its time
  Microseconds worst_step_us = 0;  // from a tick's begin to its end
  double mean_step_us = 0;
  std::uint32_t missed_samples = 0;
  std::uint32_t refused_frames = 0;
  std::uint32_t unsent_frames = 0;
  bool detected = false;
  double detection_time_s = 0;       // since arming
  int first_joint = -1;              // that was detected, from 0; -1: none, or not in TorqueSpace
  bool acts = false;                 // beyond the second level too
  double act_time_s = 0;             // since arming
  int act_joint = -1;                // that was, from 0; -1: as of first_joint
  bool slowed = false;               // the motion was
  double slow_time_s = 0;            // since arming
  SlowDownConfig<double> slow_down;  // as it was
  // The newest answer to which fault it is, of a controller WithIsolation; its time_s is 0 where
  // there was none.
  FaultDiagnosis<double> isolated;
};

// The columns of the rows that the loop records, for RecorderConfig::columns. by_joint: of a
// controller in TorqueSpace; has_fast: with a second filter.
[[nodiscard]] inline std::vector<std::string> loop_columns(int joints, bool by_joint = false,
                                                           bool has_fast = false) {
  std::vector<std::string> columns;
  const auto add_of_joints = [&](const char* quantity) {
    for (int joint = 1; joint <= joints; ++joint) {
      columns.push_back(quantity + std::to_string(joint));
    }
  };
  for (const char* quantity : {"q", "dq", "tau", "command", "psi_hat", "compensation"}) {
    add_of_joints(quantity);
  }
  if (by_joint) {
    add_of_joints("error");
    add_of_joints("threshold");
    columns.emplace_back("first_joint");
    columns.emplace_back("acts");
    if (has_fast) {
      add_of_joints("fast_error");
      add_of_joints("fast_threshold");
    }
  }
  for (const char* name : {"error", "threshold", "weights", "detected", "motion_t", "behind",
                           "slows", "late_ticks", "latency_us", "fault", "state"}) {
    columns.emplace_back(name);
  }
  return columns;
}

namespace detail {

template <int N, int L, typename Scalar, typename Memory, typename Space, typename Isolates>
[[nodiscard]] Row row_of(
    const controller::JointController<N, L, Scalar, Memory, Space, Isolates>& controller,
    const controller::ControllerData<N, L, Scalar, Memory, Space, Isolates>& data,
    const Tick& tick) {
  Row row;
  // When it was due: rows are evenly spaced.
  row.time_us = tick.begin_us - tick.latency_us;
  std::size_t next = 0;
  const auto put = [&](double value) { row.values[next++] = value; };
  const auto put_all = [&](const Vector<N, Scalar>& values) {
    for (const Scalar value : values) put(static_cast<double>(value));
  };
  const JointSample<N, Scalar>& judged = data.judged();
  put_all(judged.q);
  put_all(judged.dq);
  put_all(judged.tau);
  for (const hal::TorqueCommand& command : data.commands) put(static_cast<double>(command.torque));
  put_all(data.output.psi_hat);
  put_all(controller.acting_compensation(data));
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    put_all(data.output.error);
    put_all(data.output.thresholds);
    put(data.output.detector.latched ? data.output.detector.first_joint + 1 : 0);
    put(data.output.detector.acts ? 1 : 0);
    if (controller.monitor().config().bound.fast.alpha > 0) {
      put_all(data.output.fast_error);
      put_all(data.output.fast_thresholds);
    }
  }
  put(static_cast<double>(data.output.error_norm));
  put(static_cast<double>(data.output.threshold));
  put(std::sqrt(static_cast<double>(data.monitor.estimator.theta_squared_norm)));
  put(data.output.detector.latched ? 1 : 0);
  const double behind_s = controller.pace(data).behind_s;
  put(static_cast<double>(data.run_ticks) *
          static_cast<double>(controller.monitor().config().estimator.period_s) -
      behind_s);
  put(behind_s);
  put(data.slows ? 1 : 0);
  put(tick.late_ticks);
  put(static_cast<double>(tick.latency_us));
  put(static_cast<double>(data.fault));
  row.digit = static_cast<std::uint8_t>(data.state);
  return row;
}

}  // namespace detail

// Runs until it is asked to end, or what the configuration says. `timer` is a CycleTimer, or what
// else has its wait(). The rows are those of the ticks with a sample to judge. No heap.
template <int N, int L, typename Scalar, hal::Bus Bus, hal::DriveProtocol Drives, typename Timer,
          typename ReferenceAt, typename Space = AccelerationSpace,
          typename Isolates = WithoutIsolation>
class ControlLoop {
 public:
  using Controller = controller::JointController<N, L, Scalar, WithMemory, Space, Isolates>;
  using Data = typename Controller::Data;

  // What a loop is made of; all of it has to outlive the loop. `data` belongs on the heap.
  struct Parts {
    const Controller& controller;
    Timer& timer;
    Bus& bus;
    Drives& drives;
    const ReferenceAt& reference_at;
    Recorder& recorder;
    LoopPanel& panel;
    Data& data;
  };
  ControlLoop(const LoopConfig& config, const Parts& parts) : config_(config), parts_(parts) {}

  [[nodiscard]] LoopReport run() {
    while (!is_over()) tick(true);
    finish();
    return report_;
  }

 private:
  [[nodiscard]] bool is_over() const {
    if (parts_.panel.end.load(std::memory_order_relaxed)) return true;
    if (report_.refusal != controller::Fault::kNone) return true;
    if (end_us_ != 0 && now_us_ >= end_us_) return true;
    constexpr Microseconds kAfterFault = 100'000;
    return config_.end_at_fault && fault_us_ != 0 && now_us_ >= fault_us_ + kAfterFault;
  }

  void tick(bool obeys) {
    const Tick tick = parts_.timer.wait();
    if (obeys && !is_over()) obey(tick.begin_us);
    now_us_ = tick.begin_us;
    parts_.controller.step(tick.begin_us, tick.late_ticks, parts_.reference_at, parts_.bus,
                           parts_.drives, parts_.data);
    if (parts_.data.fresh && !parts_.controller.is_settling(parts_.data)) {
      parts_.recorder.keep(detail::row_of(parts_.controller, parts_.data, tick));
    }
    note(tick, parts_.bus.now() - tick.begin_us);
  }

  void obey(Microseconds now_us) {
    if (parts_.panel.clear.exchange(false, std::memory_order_relaxed)) {
      static_cast<void>(parts_.controller.clear_fault(parts_.drives, parts_.data));
      wish_is_over_ = true;
    }
    const bool at_once = config_.arm_when_passive && !armed_once_ && !wish_is_over_;
    const bool asked = parts_.panel.arm.exchange(false, std::memory_order_relaxed);
    if (at_once || asked) arm(asked);
    const bool counts = armed_once_ || !config_.arm_when_passive;
    if (config_.duration_us > 0 && end_us_ == 0 && counts) {
      end_us_ = now_us + config_.duration_us;
    }
  }

  void arm(bool asked) {
    const controller::Fault refusal = parts_.controller.arm(parts_.reference_at, parts_.data);
    if (refusal == controller::Fault::kNone) {
      armed_once_ = true;
      return;
    }
    const bool for_good = !passes_by_itself(refusal);
    if (asked || for_good) parts_.panel.refusal.store(refusal, std::memory_order_relaxed);
    const bool wished = config_.arm_when_passive && !armed_once_ && !wish_is_over_;
    if (wished && for_good) report_.refusal = refusal;
  }

  void note(const Tick& tick, Microseconds step_us) {
    parts_.panel.state.store(parts_.data.state, std::memory_order_relaxed);
    parts_.panel.fault.store(parts_.data.fault, std::memory_order_relaxed);
    if (parts_.data.fault != controller::Fault::kNone && fault_us_ == 0) {
      fault_us_ = now_us_;
      wish_is_over_ = true;
      report_.fault = parts_.data.fault;
    }
    if (parts_.data.output.detector.latched && !report_.detected) {
      report_.detected = true;
      report_.detection_time_s = parts_.data.output.detector.detection_time_s;
      if constexpr (std::is_same_v<Space, TorqueSpace>) {
        report_.first_joint = parts_.data.output.detector.first_joint;
      }
    }
    note_acts();
    if constexpr (std::is_same_v<Isolates, WithIsolation>) {
      if (parts_.data.isolation.triggered) note(parts_.data.isolation.diagnosis);
    }
    const Microseconds period_us = parts_.timer.period_us();
    report_.left_out += tick.late_ticks;
    report_.worst_late_us =
        std::max(report_.worst_late_us, tick.latency_us + tick.late_ticks * period_us);
    report_.worst_step_us = std::max(report_.worst_step_us, step_us);
    sum_step_us_ += step_us;
  }

  void note_acts() {
    const Data& data = parts_.data;
    if (data.output.detector.acts && !report_.acts) {
      report_.acts = true;
      report_.act_time_s = data.output.time_s;
      if constexpr (std::is_same_v<Space, TorqueSpace>) {
        report_.act_joint = static_cast<int>(first_acting(data.output));
      }
    }
    if (data.slows && !report_.slowed) {
      report_.slowed = true;
      report_.slow_time_s = data.output.time_s;
      const auto& slow_down = parts_.controller.config().slow_down;
      report_.slow_down = {static_cast<double>(slow_down.to),
                           static_cast<double>(slow_down.within_s)};
    }
  }

  // Of a tick in which some joint comes beyond its second level; of several the one that is
  // farthest beyond its first.
  template <typename Output>
  static std::size_t first_acting(const Output& output) {
    const auto& joints = output.detector.joints;
    const auto worst = static_cast<std::size_t>(output.worst_joint);
    if (joints[worst].acts) return worst;
    const auto found =
        std::find_if(joints.begin(), joints.end(), [](const auto& joint) { return joint.acts; });
    return static_cast<std::size_t>(found - joints.begin());
  }

  template <typename Found>
  void note(const Found& found) {
    const auto number = [](auto value) { return static_cast<double>(value); };
    report_.isolated = {found.kind,
                        found.joint,
                        number(found.size),
                        number(found.deviation),
                        number(found.confidence),
                        number(found.unexplained),
                        found.time_s,
                        found.onset_s,
                        found.decided};
  }

  // Nobody arms or clears any more. The drives are told "off" several times, as a frame may be
  // lost; in a fault too, whatever its safe mode: what they do without commands is theirs to know.
  void finish() {
    report_.state = parts_.data.state;
    constexpr int kFarewells = 5;
    parts_.controller.let_go(parts_.data);
    for (int i = 0; i < kFarewells; ++i) tick(false);
    report_.ticks = parts_.data.ticks;
    report_.overruns = parts_.data.overruns;
    report_.missed_samples = parts_.data.missed_samples;
    report_.refused_frames = parts_.data.refused_frames;
    report_.unsent_frames = parts_.data.unsent_frames;
    report_.mean_step_us = static_cast<double>(sum_step_us_) /
                           static_cast<double>(std::max<std::uint64_t>(1, parts_.data.ticks));
  }

  LoopConfig config_;
  Parts parts_;
  LoopReport report_;
  Microseconds now_us_ = 0;
  Microseconds end_us_ = 0;
  Microseconds fault_us_ = 0;
  Microseconds sum_step_us_ = 0;
  bool armed_once_ = false;
  bool wish_is_over_ = false;  // that of arm_when_passive
};

}  // namespace offnominal::realtime
