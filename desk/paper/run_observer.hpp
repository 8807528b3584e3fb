// What a run is judged by: gathers numbers and, where asked for, time series, tick by tick.
#pragma once

#include <cstdint>
#include <functional>
#include <offnominal/model/rigid_body_model.hpp>
#include <optional>

#include "offnominal/sim/joint_state.hpp"
#include "paper/bus_tick.hpp"
#include "paper/run_result.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::paper {

/// The loop at the end of a tick. The torque that was applied over the tick has already acted. One
/// number per joint in every vector.
struct TickRecord {
  std::int64_t tick = 0;
  double time_s = 0.0;
  sim::JointState state;
  sim::JointVector q_desired;
  sim::JointVector tau;      // applied over the tick
  sim::JointVector psi;      // true fault function at this state and torque, an acceleration
  sim::JointVector psi_hat;  // its estimate
  double error_norm = 0.0;
  double threshold = 0.0;
  double weight_norm = 0.0;
  bool detected = false;  // latched
  bool acts = false;      // the same of the second level
  bool slows = false;     // the controller has slowed the motion
  // In EstimatorSpace::kTorque, N m or N; otherwise empty, and -1.
  sim::JointVector error;
  sim::JointVector thresholds;
  sim::JointVector fast_error;  // both behind a second filter; empty: there is none
  sim::JointVector fast_thresholds;
  int first_joint = -1;  // that was detected, from 0
  std::optional<BusTick> bus;
};

using TickObserver = std::function<void(const TickRecord&)>;

class RunObserver {
 public:
  /// The robot has to outlive it. fault_time_s: until when nothing is wrong; the run's end or later
  /// where nothing ever is.
  RunObserver(const RobotDescription& robot, const RunSettings& settings, double fault_time_s);

  /// In the order of time.
  void operator()(const TickRecord& tick);

  /// Numbers and series, what the run was, but for its fault.
  [[nodiscard]] ExperimentResult finish();

 private:
  // Sums of squares over the window in which the paper's figures have settled.
  struct WindowSums {
    double tracking_rad2 = 0.0, tracking_m2 = 0.0;  // of joints that turn, and that slide
    double psi = 0.0, mismatch = 0.0;
    std::int64_t ticks = 0;
  };

  // The tick's fault function in the quantity that the monitor compares.
  [[nodiscard]] sim::JointVector fault_of(const TickRecord& tick) const;
  [[nodiscard]] bool is_guaranteed(const TickRecord& tick) const;
  void judge(const TickRecord& tick);
  void judge_joints(const TickRecord& tick, bool healthy);
  [[nodiscard]] bool acts(const TickRecord& tick, std::size_t joint) const;
  void add_to_window(const TickRecord& tick, const sim::JointVector& psi);
  void keep(const TickRecord& tick, const sim::JointVector& psi);
  void keep_joints(const TickRecord& tick);

  const RobotDescription& robot_;
  RunSettings settings_;
  double decay_, input_gain_, healthy_until_, window_start_, tolerance_;
  sim::JointVector eta_, last_psi_;
  std::optional<RigidBodyModel<kRuntimeJoints, double>> model_;  // in EstimatorSpace::kTorque
  WindowSums window_;
  ExperimentResult result_;
};

}  // namespace offnominal::desk::paper
