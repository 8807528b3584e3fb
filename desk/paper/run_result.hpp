// What was asked of a run, and what it showed, for any number of joints.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/precision.hpp"
#include "offnominal/sim/fault.hpp"
#include "paper/bus_tick.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::paper {

inline constexpr double kLongestRunS = 1e5;
inline constexpr double kMinPeriod = 1e-5;  // s
inline constexpr double kMaxPeriod = 0.02;  // s; the paper's gains bear little more

struct RunSettings {
  bool accommodate = false;  // add the compensating torque, eq. (31)
  Precision precision = Precision::kFloat;
  double duration_s = 20.0;
  bool record = false;  // keep the time series
};

/// What happened at every tick, all of the same length; [joint] where there is one per joint. In
/// EstimatorSpace::kTorque faults and their estimates are torques of the joints, N m or N (beta psi
/// times the mass matrix of the model), error and threshold those of the joint that is nearest to
/// its own.
struct TimeSeries {
  std::vector<double> time_s;
  std::vector<std::vector<double>> q;          // rad
  std::vector<std::vector<double>> dq;         // rad/s
  std::vector<std::vector<double>> tau;        // applied over the tick, N m
  std::vector<std::vector<double>> q_desired;  // rad
  std::vector<std::vector<double>> psi;        // fault function beta psi, rad/s^2
  std::vector<std::vector<double>> psi_hat;    // its estimate, rad/s^2
  std::vector<double> error_norm;              // |e|, rad/s
  std::vector<double> threshold;               // mu, the filtered uncertainty bound, rad/s
  std::vector<double> filtered_fault;          // |eta|, eta = W_alpha[beta psi], rad/s
  // Of a monitor that judges joint by joint, N m or N; otherwise empty.
  std::vector<std::vector<double>> joint_residual;   // |alpha e_i|
  std::vector<std::vector<double>> joint_threshold;  // alpha mu_i
  std::vector<std::vector<double>> joint_fault;      // |alpha eta_i|
  // Residual and threshold behind a second filter; empty where there is none.
  std::vector<std::vector<double>> joint_fast_residual;
  std::vector<std::vector<double>> joint_fast_threshold;
  std::vector<BusTick> bus;  // empty where there is none
};

/// What a monitor that judges joint by joint said of one.
struct JointRun {
  std::string name;
  std::string unit;                        // of its torque
  std::optional<double> detection_time_s;  // first crossing
  std::optional<double> act_time_s;        // of the second level, of either filter
  double act_ratio = 1;                    // of that level to the threshold
  double fast_act_ratio = 1;               // the same behind the second filter
  double max_error_to_threshold_before_fault = 0;
};

struct ExperimentResult {
  sim::FaultKind fault = sim::FaultKind::kNone;
  bool accommodate = false;
  Precision precision = Precision::kFloat;
  std::uint32_t seed = 0;
  std::int64_t steps = 0;
  std::optional<double> fault_time_s;       // none without a fault
  std::optional<double> detection_time_s;   // first |e| > mu; none where it never was
  std::optional<double> guaranteed_time_s;  // first |eta| > 2 mu (Theorem 4.2)
  bool has_two_levels = false;              // BoundSettings::has_two_levels()
  std::optional<double> act_time_s;         // beyond the second level; of one level as detected
  std::optional<double> slowed_time_s;      // the controller slowed the motion; none: it did not
  // Largest over the ticks up to the fault; over the whole run without one.
  double max_error_to_threshold_before_fault = 0.0;
  double max_abs_psi_hat_before_fault = 0.0;  // over joints too, rad/s^2
  // Over the last quarter of the run (15 to 20 s in the paper's runs):
  double tracking_rms_rad = 0.0;         // norm over the joints that turn; NaN where none does
  std::optional<double> tracking_rms_m;  // over those that slide; none where none does
  std::optional<double> fault_estimate_relative_error;  // ||psi - psi_hat|| / ||psi||
  double max_weight_norm = 0.0;                         // |theta|
  std::vector<JointRun> joints;                         // empty unless in EstimatorSpace::kTorque
  std::optional<int> first_joint;  // that was detected, from 0; none unless there
  TimeSeries series;               // empty unless recorded
};

/// Throws InputError, before anything runs and in the name of `verb`, for a robot without a bound
/// or with a step or a network that no run can have, and for a length that is none.
void check_run(const RobotDescription& robot, const RunSettings& settings, const std::string& verb);

}  // namespace offnominal::desk::paper
