#pragma once

#include <memory>

#include "offnominal/sim/joint_state.hpp"
#include "replay/watch.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::campaign {

/// A monitor in torque space in the loop of a run, which asks which fault it is, as a controller
/// with `isolation = true` does.
class Accommodation {
 public:
  /// Of a robot with a bound, for samples every period_s.
  Accommodation(const RobotDescription& robot, double period_s);

  /// Takes the sample at t_s; what the drives are to give beside from then on, N m. 0 until it is
  /// decided that the fault is one that this is right for.
  [[nodiscard]] sim::JointVector after(const Watch::Sample& sample, double t_s);

 private:
  std::unique_ptr<Watch> watch_;
  Eigen::Index joints_;
};

}  // namespace offnominal::desk::campaign
