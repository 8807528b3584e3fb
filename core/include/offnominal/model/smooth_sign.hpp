#pragma once

#include <Eigen/Core>

namespace offnominal {

// A differentiable stand-in for sgn(velocity): tanh(velocity / width). It reaches 0.76 at
// |velocity| = width and 0.995 at three times that. width > 0, in the unit of velocity; NaN gives
// NaN. Eigen's tanh is a fixed rational for float: the same cost for every argument.
template <typename Scalar>
[[nodiscard]] inline Scalar smooth_sign(Scalar velocity, Scalar width) {
  return Eigen::numext::tanh(velocity / width);
}

}  // namespace offnominal
