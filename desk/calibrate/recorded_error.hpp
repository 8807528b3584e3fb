#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

// A fault-free recording as the on-board monitor sees it, with learning held off.

namespace offnominal::desk {

/// The estimator's filter W_alpha over one tick, as its Runge-Kutta step has it: a state y with the
/// input x, linear from x_begin to x_end inside the tick, ends at
/// keep * y + begin * x_begin + end * x_end.
struct TickFilter {
  double keep = 0;
  double begin = 0;
  double end = 0;
};
[[nodiscard]] TickFilter tick_filter(double alpha_per_s, double period_s);

/// Rows: samples, columns: joints.
struct RecordedSignals {
  Eigen::MatrixXd q;
  Eigen::MatrixXd dq;
  Eigen::MatrixXd tau;
};

/// Sample 0 is the start of the run, where |e| is 0 and nothing is judged.
struct RecordedError {
  std::string file;
  // Of e: "rad/s", "m/s", or "1" where joints of both types are mixed; "N m" or "N" of one joint.
  std::string unit;
  double period_s = 0;
  Eigen::VectorXd t_s;         // as recorded
  Eigen::VectorXd error_norm;  // |e|, what `offnominal replay` shows before any alarm
  // |e| after the first tick of a run that starts one sample earlier; entry 0 is 0.
  Eigen::VectorXd first_tick;
  Eigen::VectorXi loudest_joint;  // from 0; the one with the largest |e_j| at the sample
  Eigen::VectorXd old_threshold;  // mu of the robot file's own bound; empty: it has none
  std::shared_ptr<const RecordedSignals> signals;  // one for all joints of a recording

  // 1, or of one joint's residual alpha: by which the filter's output is multiplied here.
  double scale = 1;
  Eigen::VectorXd residual;  // of one joint, with its sign; empty of |e|

  [[nodiscard]] Eigen::Index samples() const { return t_s.size(); }
  [[nodiscard]] double duration_s() const { return static_cast<double>(samples() - 1) * period_s; }
};

/// The same of each joint of a robot with EstimatorSpace::kTorque: residuals and thresholds in N m
/// or N, behind the filter's alpha.
[[nodiscard]] std::vector<RecordedError> joint_errors(const RobotDescription& robot,
                                                      const Log& log);

/// The thresholds of these joints alone, columns: joints. The robot has a bound.
[[nodiscard]] Eigen::MatrixXd joint_thresholds(const RobotDescription& robot, const Log& log);

/// Runs the monitor of `robot` over `log` without learning. Throws InputError as replay() does, and
/// where a sample is refused: what the monitor would not look at cannot calibrate it.
[[nodiscard]] RecordedError recorded_error(const RobotDescription& robot, const Log& log);

}  // namespace offnominal::desk
