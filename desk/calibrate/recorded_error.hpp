#pragma once

#include <Eigen/Core>
#include <memory>
#include <offnominal/diagnosis/tick_filter.hpp>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

// A fault-free recording as the on-board monitor sees it, with learning held off.

namespace offnominal::desk {

/// A run that starts `ticks` before a sample stands there where this recording's run does, less
/// `kept` times where that was at the start: the filter is linear, and zero in the beginning.
struct StartBefore {
  Eigen::Index ticks = 0;
  double kept = 0;  // keep^ticks
};
/// One tick before a sample, and then ever further, until a run is what the recording's own is.
[[nodiscard]] std::vector<StartBefore> starts_before(const TickFilter<double>& filter);

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
  double alpha_per_s = 0;         // pole of the filter behind which it is
  Eigen::VectorXd t_s;            // as recorded
  Eigen::MatrixXd error;          // e with its signs, rows: samples; of one joint a single column
  Eigen::VectorXd error_norm;     // |e|, what `offnominal replay` shows before any alarm
  Eigen::VectorXi loudest_joint;  // from 0; the one with the largest |e_j| at the sample
  Eigen::VectorXd old_threshold;  // mu of the robot file's own bound; empty: it has none
  std::shared_ptr<const RecordedSignals> signals;  // one for all joints of a recording

  // 1, or of one joint's residual alpha: by which the filter's output is multiplied here.
  double scale = 1;
  bool of_one_joint = false;

  /// |e| at the samples from `begin` to `end` - 1 of runs that start so many ticks earlier each; 0
  /// where the recording does not reach back so far.
  [[nodiscard]] Eigen::VectorXd error_norm_after(const StartBefore& start, Eigen::Index begin,
                                                 Eigen::Index end) const;

  [[nodiscard]] Eigen::Index samples() const { return t_s.size(); }
  /// What the filter does in a tick.
  [[nodiscard]] TickFilter<double> filter() const { return tick_filter(alpha_per_s, period_s); }
  [[nodiscard]] double duration_s() const { return static_cast<double>(samples() - 1) * period_s; }
};

/// One value for the estimator's own filter and one for the fast filter beside it.
template <typename Value>
struct OfFilters {
  Value slow{};
  Value fast{};  // empty: the robot has none
};

/// The same of each joint of a robot with EstimatorSpace::kTorque: residuals and thresholds in N m
/// or N, behind each filter's alpha.
[[nodiscard]] OfFilters<std::vector<RecordedError>> joint_errors(const RobotDescription& robot,
                                                                 const Log& log);

/// The thresholds of these joints alone, columns: joints. The robot has a bound.
[[nodiscard]] OfFilters<Eigen::MatrixXd> joint_thresholds(const RobotDescription& robot,
                                                          const Log& log);

/// Runs the monitor of `robot` over `log` without learning. Throws InputError as replay() does, and
/// where a sample is refused: what the monitor would not look at cannot calibrate it.
[[nodiscard]] RecordedError recorded_error(const RobotDescription& robot, const Log& log);

}  // namespace offnominal::desk
