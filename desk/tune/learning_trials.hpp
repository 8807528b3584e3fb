#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"
#include "tune/tune.hpp"

namespace offnominal::desk {

/// A recording of the healthy robot with torques that nobody ordered: of each joint in turn, one
/// that is constant and one that turns with the velocity, as friction does. The motion stays; the
/// recorded torque is what the drive would have had to give beside.
class LearningTrials {
 public:
  /// At most 12 s of the longest recording; `torques`: sizes to try, each per joint, N m or N.
  /// `robot` has bounds.
  LearningTrials(const RobotDescription& robot, const std::vector<Log>& logs,
                 std::vector<Eigen::VectorXd> torques, std::function<void()> on_step);

  /// With these settings in place of the robot's.
  [[nodiscard]] LearningTrial run(const EstimatorSettings& settings) const;
  [[nodiscard]] double seconds() const {
    return recording_.period_s * static_cast<double>(recording_.sample_count());
  }

  /// sqrt(3) over the rms length of the network's input [1 q dq tau]: weights that are uniform up
  /// to it give arguments of a standard deviation of 1.
  [[nodiscard]] double weight_range() const;

 private:
  [[nodiscard]] std::pair<double, double> missed_of(const RobotDescription& robot,
                                                    Eigen::Index joint,
                                                    const Eigen::VectorXd& extra,
                                                    double from_s) const;

  RobotDescription robot_;
  Log recording_;
  std::vector<Eigen::VectorXd> torques_;
  std::function<void()> on_step_;
};

}  // namespace offnominal::desk
