// The experiment of the paper's section 5: the simulated two-link arm under computed torque, with
// the core's monitor beside the controller and, if asked for, its compensating torque.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/precision.hpp"
#include "offnominal/sim/fault.hpp"
#include "offnominal/sim/trajectory.hpp"
#include "offnominal/sim/two_link_plant.hpp"
#include "offnominal/sim/uncertainty.hpp"
#include "paper/bus_tick.hpp"
#include "paper/recorded_motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools::paper {

inline constexpr int kMaxHiddenUnits = 256;
inline constexpr double kLongestRunS = 1e5;
inline constexpr double kMinPeriod = 1e-5;  // s
inline constexpr double kMaxPeriod = 0.02;  // s; the paper's gains bear little more

/// One run. Everything about the estimator and the controller stands in the robot's description.
struct Experiment {
  sim::Fault fault;
  sim::Uncertainty uncertainty = sim::paper_uncertainty();
  bool accommodate = false;  // add the compensating torque, eq. (31)
  Precision precision = Precision::kFloat;
  double duration_s = 20.0;
  double motion_start_s = 0.0;  // time on the desired motion at which the run starts
  std::shared_ptr<const RecordedMotion> motion;  // in place of the paper's; null: the paper's

  /// What the arm shall do at a time of the run.
  [[nodiscard]] sim::DesiredMotion desired_at(double time_s) const;
  int plant_substeps = 1;  // Runge-Kutta steps of the plant in one tick
  bool record = false;     // keep the time series
};

/// What happened at every tick, all of the same length; [joint] where there are two.
struct TimeSeries {
  std::vector<double> time_s;
  std::vector<double> q[2];            // rad
  std::vector<double> dq[2];           // rad/s
  std::vector<double> tau[2];          // applied over the tick, N m
  std::vector<double> q_desired[2];    // rad
  std::vector<double> psi[2];          // fault function beta psi, rad/s^2
  std::vector<double> psi_hat[2];      // its estimate, rad/s^2
  std::vector<double> error_norm;      // |e|, rad/s
  std::vector<double> threshold;       // mu, the filtered uncertainty bound, rad/s
  std::vector<double> filtered_fault;  // |eta|, eta = W_alpha[beta psi], rad/s
  std::vector<BusTick> bus;            // empty where there is none
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
  // Largest over the ticks up to the fault; over the whole run without one.
  double max_error_to_threshold_before_fault = 0.0;
  double max_abs_psi_hat_before_fault = 0.0;  // over joints too, rad/s^2
  // Over the last quarter of the run (15 to 20 s in the paper's runs):
  double tracking_rms_rad = 0.0;                        // norm over joints
  std::optional<double> fault_estimate_relative_error;  // ||psi - psi_hat|| / ||psi||
  double max_weight_norm = 0.0;                         // |theta|
  TimeSeries series;                                    // empty unless recorded
};

/// Runs one experiment with the monitor and controller that `robot` describes: two joints, with an
/// uncertainty bound. Throws InputError where the robot or the experiment cannot be used, or where
/// the closed loop leaves the range of finite numbers, and names the setting at fault.
[[nodiscard]] ExperimentResult run_experiment(const RobotDescription& robot,
                                              const Experiment& experiment);

/// Throws InputError where run_experiment() would, before anything runs, in the name of `verb`.
void check_experiment(const RobotDescription& robot, const Experiment& experiment,
                      const std::string& verb);

/// The arm of an experiment. Throws InputError where its fault cannot be.
[[nodiscard]] sim::TwoLinkPlant plant_of(const Experiment& experiment);

[[nodiscard]] std::string name_of(sim::FaultKind fault);  // none, mass_loss, nonlinear

}  // namespace offnominal::tools::paper
