#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// Evenly spaced samples as they are `samples` (any number, not only whole ones) later:
// result[k] = signal(k + samples), by the cubic through the four samples around it, which is off by
// (w T)^4 / 43 at most for sin(w t) sampled every T. Beyond its ends the signal stays what it is
// there.
Eigen::VectorXd ahead_by(const Eigen::Ref<const Eigen::VectorXd>& signal, double samples);

}  // namespace offnominal::desk
