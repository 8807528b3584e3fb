#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

inline constexpr int kMaxJointBoundPoints = 8;

// What the unmodelled torque of one joint does not exceed, N m or N: linear between points over one
// variable of that joint, the end values beyond both ends. One point is a constant, whatever its
// abscissa. As with the paper's bound only the filtered values are compared.
template <typename Scalar>
struct JointBound {
  BoundVariable variable = BoundVariable::kSpeed;  // its own q, |dq| or |tau|
  std::uint8_t points = 1;
  std::array<Scalar, kMaxJointBoundPoints> at{};      // strictly rising
  std::array<Scalar, kMaxJointBoundPoints> value{1};  // > 0
  // Largest error of the momentum p by that of the measured velocities, N m s or N s, >= 0. It
  // raises the threshold of e by twice its size (docs/theory.md); evaluate() leaves it out.
  Scalar momentum_error{};
  // The second level: so many times the threshold, >= 1. Beyond the threshold a joint is reported,
  // beyond this somebody may act (DetectorState::acts).
  Scalar act_ratio = 1;
};

// Of a second, faster filter of the same residuals (fast_filter.hpp).
template <int N, typename Scalar>
struct FastBound {
  Scalar alpha{};  // its pole, 1/s, above the estimator's; 0: there is no such filter
  PerJoint<N, JointBound<Scalar>> joints{};
};

template <int N, typename Scalar>
struct TorqueBound {
  PerJoint<N, JointBound<Scalar>> joints{};
  FastBound<N, Scalar> fast{};
};

template <typename Scalar>
[[nodiscard]] Status validate(const JointBound<Scalar>& bound) {
  const bool known = is_finite(bound.momentum_error) && bound.momentum_error >= 0 &&
                     is_finite(bound.act_ratio) && bound.act_ratio >= 1 && bound.points >= 1 &&
                     bound.points <= kMaxJointBoundPoints;
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
  if (bound.fast.alpha == 0) return Status::kOk;
  if (bound.fast.joints.size() != joints) return Status::kWrongJointCount;
  for (const JointBound<Scalar>& joint : bound.fast.joints) {
    if (const Status status = validate(joint); status != Status::kOk) return status;
  }
  return Status::kOk;
}

// At q, |dq| or |tau| of the joint; > 0 for a valid bound. NaN gives a value of the table or NaN.
template <typename Scalar>
[[nodiscard]] Scalar evaluate(const JointBound<Scalar>& bound, Scalar at) {
  Scalar result = bound.value[0];
  for (std::size_t i = 1; i < bound.points; ++i) {
    const Scalar part = (at - bound.at[i - 1]) / (bound.at[i] - bound.at[i - 1]);
    result += std::clamp(part, Scalar(0), Scalar(1)) * (bound.value[i] - bound.value[i - 1]);
  }
  return result;
}

// Wherever the joint is.
template <typename Scalar>
[[nodiscard]] Scalar largest_value(const JointBound<Scalar>& bound) {
  Scalar largest = bound.value[0];
  for (std::size_t i = 1; i < bound.points; ++i) largest = std::max(largest, bound.value[i]);
  return largest;
}

// mu_bar per joint at one instant, N m or N.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> evaluate(const PerJoint<N, JointBound<Scalar>>& bounds,
                                         const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                         const Vector<N, Scalar>& tau) {
  Vector<N, Scalar> values;
  values.resize(dq.size());
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    const JointBound<Scalar>& bound = bounds[static_cast<std::size_t>(i)];
    const Scalar at = bound.variable == BoundVariable::kPosition ? q[i]
                      : bound.variable == BoundVariable::kSpeed  ? Eigen::numext::abs(dq[i])
                                                                 : Eigen::numext::abs(tau[i]);
    values[i] = evaluate(bound, at);
  }
  return values;
}

// What the velocities' own errors add to the thresholds of e, N m s or N s.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> momentum_allowance(const PerJoint<N, JointBound<Scalar>>& bounds) {
  Vector<N, Scalar> values;
  values.resize(static_cast<Eigen::Index>(bounds.size()));
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] = 2 * bounds[i].momentum_error;
  }
  return values;
}

// Where the bounds at their largest would have brought the thresholds of a filter with the pole
// alpha, N m s or N s: what the robot did before a run is not known, and in its first ticks it may
// err as much as the bound says anywhere.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> first_threshold(const PerJoint<N, JointBound<Scalar>>& bounds,
                                                Scalar alpha) {
  Vector<N, Scalar> values = momentum_allowance<N, Scalar>(bounds);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] += largest_value(bounds[i]) / alpha;
  }
  return values;
}

// Whether any of them is over the load.
template <typename Bounds>
[[nodiscard]] bool follows_torque(const Bounds& bounds) {
  for (const auto& bound : bounds) {
    if (bound.points > 1 && bound.variable == BoundVariable::kTorque) return true;
  }
  return false;
}

}  // namespace offnominal
