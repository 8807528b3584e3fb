#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// Values at `wanted` of the natural cubic spline through (at, value): for smooth quantities such
// as positions. Throws std::invalid_argument unless `at` ascends strictly, has at least 3 points,
// is as long as `value`, and every wanted point lies within it.
Eigen::VectorXd spline_at(const Eigen::Ref<const Eigen::VectorXd>& at,
                          const Eigen::Ref<const Eigen::VectorXd>& value,
                          const Eigen::Ref<const Eigen::VectorXd>& wanted);

// Straight lines between the points: for quantities with steps, such as torques. Errors as above.
Eigen::VectorXd linear_at(const Eigen::Ref<const Eigen::VectorXd>& at,
                          const Eigen::Ref<const Eigen::VectorXd>& value,
                          const Eigen::Ref<const Eigen::VectorXd>& wanted);

}  // namespace offnominal::desk
