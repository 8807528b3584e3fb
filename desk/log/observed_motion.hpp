#pragma once

#include <Eigen/Core>
#include <offnominal/diagnosis/observed_motion.hpp>
#include <offnominal/joint_count.hpp>
#include <offnominal/sample.hpp>
#include <vector>

#include "log/log.hpp"

// What a controller judges whose drives send positions alone: position, velocity and torque of one
// time, 2 / bandwidth ago (offnominal/diagnosis/observed_motion.hpp). A recording of such drives is
// to the monitor what it is on the robot.

namespace offnominal::desk {

/// Of all joints, sample by sample, with the observer that every controller has by default.
class MotionObserver {
 public:
  using Sample = JointSample<kRuntimeJoints, double>;

  MotionObserver(Eigen::Index joints, double period_s);

  /// The next tick's positions, rad or m, and torques, N m or N. What they come to, valid until the
  /// next call; null until the velocities have settled, some fifty ticks, and for numbers that are
  /// none.
  const Sample* take(const Eigen::VectorXd& q, const Eigen::VectorXd& tau);

  [[nodiscard]] double bandwidth_rad_s() const { return config_.bandwidth_rad_s; }
  /// How many of the first ticks come to nothing.
  [[nodiscard]] Eigen::Index ticks_to_settle() const;

 private:
  VelocityObserverConfig<double> config_;
  std::vector<ObservedMotionState<double>> joints_;
  Sample sample_;
};

/// The recording from the first sample on of which the velocities are settled, as such a controller
/// judges it, whatever velocities were recorded; its `readings` are the positions as they were.
/// Throws InputError where nothing is left.
[[nodiscard]] Log as_observed(const Log& log);

}  // namespace offnominal::desk
