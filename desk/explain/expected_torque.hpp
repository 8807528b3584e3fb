#pragma once

#include <Eigen/Core>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What the model says of the torques of an evenly sampled recording, low-passed: for how they
// change, not for how large they are.
class ExpectedTorque {
 public:
  // Enough to see how a torque changes; of longer recordings every so many-th sample is taken.
  static constexpr Eigen::Index kMostSamples = 5000;

  ExpectedTorque(const Log& even, const RobotDescription& robot,
                 Eigen::Index most_samples = kMostSamples);

  // Of that low-pass, Hz.
  [[nodiscard]] static double cutoff_hz(const Log& even);
  // At the sample before a time, or next to it; N m or N.
  [[nodiscard]] double at(double t_s, Eigen::Index joint) const;
  // A joint's measured torque less that, per row of `log`, whose rows may be uneven in time.
  [[nodiscard]] Eigen::VectorXd torque_beyond(const Log& log, Eigen::Index joint) const;
  // Between its largest and its smallest from one time to another.
  [[nodiscard]] double change_during(double from_s, double to_s, Eigen::Index joint) const;
  // The same of the means of eight parts of that time but the first and the last: neither what a
  // coarse encoder makes of it nor a friction that changes its sign a little earlier than it does.
  [[nodiscard]] double lasting_change_during(double from_s, double to_s, Eigen::Index joint) const;
  // Of the recording, not only of those taken; not beyond its ends.
  [[nodiscard]] Eigen::Index sample_at(double t_s) const;
  // Those taken; columns: joints.
  [[nodiscard]] const Eigen::MatrixXd& torque() const { return torque_; }

 private:
  Eigen::Index samples_;
  Eigen::Index stride_;
  double from_s_;
  double period_s_;
  Eigen::MatrixXd torque_;
};

}  // namespace offnominal::desk
