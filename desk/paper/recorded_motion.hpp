#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "offnominal/sim/trajectory.hpp"

namespace offnominal::desk::paper {

/// A desired motion from a file, as `offnominal motion` writes it.
class RecordedMotion {
 public:
  struct Joint {
    double q = 0, dq = 0, ddq = 0;
  };

  /// CSV with the columns t, q1, q2, ..., dq1, ..., ddq1, ... in SI units, t ascending. Throws
  /// InputError with the line where it is none.
  static RecordedMotion read(const std::filesystem::path& file, int joints = 2);

  /// Time from the first row to the last, s.
  [[nodiscard]] double duration_s() const { return t_s_[t_s_.size() - 1]; }
  /// t_s from 0 at the first row; before it and after the last the motion stands where that is.
  /// Between rows a cubic through positions and velocities, the acceleration on straight lines.
  /// Joint from 0. No heap.
  [[nodiscard]] Joint at(double t_s, int joint) const;
  /// Of all joints.
  [[nodiscard]] sim::DesiredMotion at(double t_s) const;

 private:
  Eigen::VectorXd t_s_;
  Eigen::MatrixXd q_, dq_, ddq_;
};

}  // namespace offnominal::desk::paper
