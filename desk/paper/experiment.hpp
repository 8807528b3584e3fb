// The experiment of the paper's section 5: the simulated two-link arm under computed torque, with
// the core's monitor beside the controller and, if asked for, its compensating torque.
#pragma once

#include <memory>
#include <string>

#include "offnominal/sim/fault.hpp"
#include "offnominal/sim/trajectory.hpp"
#include "offnominal/sim/two_link_plant.hpp"
#include "offnominal/sim/uncertainty.hpp"
#include "paper/recorded_motion.hpp"
#include "paper/run_result.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::paper {

/// One run. Everything about the estimator and the controller stands in the robot's description.
struct Experiment : RunSettings {
  sim::Fault fault;
  sim::Uncertainty uncertainty = sim::paper_uncertainty();
  double motion_start_s = 0.0;  // time on the desired motion at which the run starts
  std::shared_ptr<const RecordedMotion> motion;  // in place of the paper's; null: the paper's

  /// What the arm shall do at a time of the run.
  [[nodiscard]] sim::DesiredMotion desired_at(double time_s) const;
  int plant_substeps = 1;  // Runge-Kutta steps of the plant in one tick
};

/// Runs one experiment with the monitor and controller that `robot` describes: two joints, with an
/// uncertainty bound. Throws InputError where the robot or the experiment cannot be used, or where
/// the closed loop leaves the range of finite numbers, and names the setting at fault.
[[nodiscard]] ExperimentResult run_experiment(const RobotDescription& robot,
                                              const Experiment& experiment);

/// Throws InputError where run_experiment() would, before anything runs, in the name of `verb`.
void check_experiment(const RobotDescription& robot, const Experiment& experiment,
                      const std::string& verb);

/// Throws InputError, with `file` in it, where the robot's monitor compares in another space than
/// the paper's.
void require_acceleration_space(const RobotDescription& robot, const std::string& file);

/// The arm of an experiment. Throws InputError where its fault cannot be.
[[nodiscard]] sim::TwoLinkPlant plant_of(const Experiment& experiment);

[[nodiscard]] std::string name_of(sim::FaultKind fault);  // none, mass_loss, nonlinear

}  // namespace offnominal::desk::paper
