#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

inline constexpr int kMaxJointBoundPoints = 8;

// What the unmodelled torque of one joint does not exceed, N m or N: linear between points over the
// joint's own speed |dq|, rad/s or m/s, the end values beyond both ends. One point is a constant,
// whatever its abscissa. As with the paper's bound only the filtered values are compared.
template <typename Scalar>
struct JointBound {
  std::uint8_t points = 1;
  std::array<Scalar, kMaxJointBoundPoints> at{};      // strictly rising
  std::array<Scalar, kMaxJointBoundPoints> value{1};  // > 0
  // Largest error of the momentum p by that of the measured velocities, N m s or N s, >= 0. It
  // raises the threshold of e by twice its size (docs/theory.md); evaluate() leaves it out.
  Scalar momentum_error{};
};

template <int N, typename Scalar>
struct TorqueBound {
  PerJoint<N, JointBound<Scalar>> joints{};
};

template <typename Scalar>
[[nodiscard]] Status validate(const JointBound<Scalar>& bound) {
  const bool known = is_finite(bound.momentum_error) && bound.momentum_error >= 0 &&
                     bound.points >= 1 && bound.points <= kMaxJointBoundPoints;
  if (!known) return Status::kInvalidBound;
  for (std::size_t i = 0; i < bound.points; ++i) {
    if (!is_finite(bound.at[i]) || !is_finite(bound.value[i]) || bound.value[i] <= 0) {
      return Status::kInvalidBound;
    }
    if (i > 0 && bound.at[i] <= bound.at[i - 1]) return Status::kInvalidBound;
  }
  return Status::kOk;
}

// For a chain of `joints` joints. kWrongJointCount: a bound of other joints.
template <int N, typename Scalar>
[[nodiscard]] Status validate(const TorqueBound<N, Scalar>& bound,
                              std::size_t joints = static_cast<std::size_t>(N)) {
  if (bound.joints.size() != joints) return Status::kWrongJointCount;
  for (const JointBound<Scalar>& joint : bound.joints) {
    if (const Status status = validate(joint); status != Status::kOk) return status;
  }
  return Status::kOk;
}

// At the speed |dq|; > 0 for a valid bound. NaN gives a value of the table or NaN.
template <typename Scalar>
[[nodiscard]] Scalar evaluate(const JointBound<Scalar>& bound, Scalar speed) {
  Scalar result = bound.value[0];
  for (std::size_t i = 1; i < bound.points; ++i) {
    const Scalar part = (speed - bound.at[i - 1]) / (bound.at[i] - bound.at[i - 1]);
    result += std::clamp(part, Scalar(0), Scalar(1)) * (bound.value[i] - bound.value[i - 1]);
  }
  return result;
}

// At whatever speed.
template <typename Scalar>
[[nodiscard]] Scalar largest_value(const JointBound<Scalar>& bound) {
  Scalar largest = bound.value[0];
  for (std::size_t i = 1; i < bound.points; ++i) largest = std::max(largest, bound.value[i]);
  return largest;
}

// mu_bar per joint at one instant, N m or N.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> evaluate(const TorqueBound<N, Scalar>& bound,
                                         const Vector<N, Scalar>& dq) {
  Vector<N, Scalar> values;
  values.resize(dq.size());
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    values[i] = evaluate(bound.joints[static_cast<std::size_t>(i)], Eigen::numext::abs(dq[i]));
  }
  return values;
}

}  // namespace offnominal
