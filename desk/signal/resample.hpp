#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

/// The natural cubic spline through (at, value), for smooth quantities such as positions; solved
/// once, asked as often as wanted.
class Spline {
 public:
  /// Throws std::invalid_argument unless `at` ascends strictly, has at least 3 points and is as
  /// long as `value`.
  Spline(Eigen::VectorXd at, Eigen::VectorXd value);

  /// Values at `wanted`; quickest where they ascend. Throws std::invalid_argument unless every one
  /// lies within `at`.
  [[nodiscard]] Eigen::VectorXd at(const Eigen::Ref<const Eigen::VectorXd>& wanted) const;

 private:
  Eigen::VectorXd at_;
  Eigen::VectorXd value_;
  Eigen::VectorXd bend_;  // second derivatives at its points
};

// Values of that spline, of one that is asked once. Errors as above.
Eigen::VectorXd spline_at(const Eigen::Ref<const Eigen::VectorXd>& at,
                          const Eigen::Ref<const Eigen::VectorXd>& value,
                          const Eigen::Ref<const Eigen::VectorXd>& wanted);

// Straight lines between the points: for quantities with steps, such as torques. Errors as above.
Eigen::VectorXd linear_at(const Eigen::Ref<const Eigen::VectorXd>& at,
                          const Eigen::Ref<const Eigen::VectorXd>& value,
                          const Eigen::Ref<const Eigen::VectorXd>& wanted);

}  // namespace offnominal::desk
