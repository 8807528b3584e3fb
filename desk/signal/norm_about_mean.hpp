#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// |x - mean of x|: sqrt(n) standard deviations; 0 of a constant, but for rounding. There must be at
// least one value.
[[nodiscard]] inline double norm_about_mean(const Eigen::VectorXd& x) {
  return (x.array() - x.mean()).matrix().norm();
}

}  // namespace offnominal::desk
