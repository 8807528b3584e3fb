#pragma once

#include <Eigen/Core>
#include <offnominal/vector.hpp>

// In which quantity the estimator compares the robot with its model; policies of everything from
// the estimator to the monitor. What each says of the estimator is here, of the monitor in
// monitor_form.hpp.

namespace offnominal {

// The paper's: y = dq, y' = f = M^-1 (...), one threshold of the norm of e.
struct AccelerationSpace {
  template <int N, typename Scalar>
  using Threshold = Scalar;
  // What is filtered is in the network's input already.
  template <int N, typename Scalar>
  struct Measured {};
  template <int N, typename Scalar>
  [[nodiscard]] static Scalar no_threshold(Eigen::Index /*joints*/) {
    return Scalar(0);
  }
};

// y = p = M(q) dq, y' = load + dT/dq - G: each component of e is that joint's alone, and has a
// threshold of its own.
struct TorqueSpace {
  template <int N, typename Scalar>
  using Threshold = Vector<N, Scalar>;
  template <int N, typename Scalar>
  struct Measured {
    Vector<N, Scalar> momentum = zeros<N, Scalar>();  // p, N m s or N s
  };
  template <int N, typename Scalar>
  [[nodiscard]] static Vector<N, Scalar> no_threshold(Eigen::Index joints) {
    return zeros<N, Scalar>(joints);
  }
};

}  // namespace offnominal
