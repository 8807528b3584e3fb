#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <offnominal/diagnosis/fault_law.hpp>
#include <offnominal/diagnosis/isolation_bank.hpp>
#include <offnominal/diagnosis/isolation_scales.hpp>
#include <offnominal/diagnosis/isolation_state.hpp>
#include <offnominal/finite.hpp>

// The law of the fault that is told, with the numbers of its regression.

namespace offnominal::detail {

// A number, less by a standard deviation: too much of a law is worse than too little.
template <typename Scalar>
[[nodiscard]] Scalar surely(Scalar value, Scalar variance) {
  const Scalar size = Eigen::numext::abs(value) - std::sqrt(variance);
  return size > 0 ? std::copysign(size, value) : Scalar(0);
}

// At one speed dry and viscous friction are one, and the wrong one of them pushes where nothing is:
// both only where they are better than dry friction alone.
template <typename Scalar>
[[nodiscard]] Vector<kOwnRegressors, Scalar> friction_law(
    const Regression<kOwnRegressors, Scalar>& sums) {
  Vector<kOwnRegressors, Scalar> own = Vector<kOwnRegressors, Scalar>::Zero();
  const auto dry = fit_of(part_of<kSignRegressor>(sums));
  const auto both = fit_of(part_of<kSignRegressor, kVelocityRegressor>(sums));
  if (dry.evidence >= both.evidence) {
    own[kSignRegressor] = surely(dry.theta[0], dry.covariance(0, 0));
  } else {
    own[kSignRegressor] = surely(both.theta[0], both.covariance(0, 0));
    own[kVelocityRegressor] = surely(both.theta[1], both.covariance(1, 1));
  }
  return own;
}

// Known where the kind has a law, the answer is clear and the numbers are finite. `sign_width`:
// IsolationConfig's; `confidence`: from which on it is clear.
template <int N, typename Scalar>
[[nodiscard]] FaultLaw<N, Scalar> law_of(const IsolationState<N, Scalar>& state,
                                         const IsolationScales<N, Scalar>& scales,
                                         Scalar confidence) {
  // Of the velocities' noise nothing is to be put on the drives.
  constexpr auto kWidths = Scalar(4);
  // What is told to make up for a lost torque is lost in part itself: the share is the loop's gain.
  constexpr auto kMostLost = Scalar(0.8);
  constexpr auto kMostGained = Scalar(0.5);
  const FaultDiagnosis<Scalar>& fault = state.diagnosis;
  const auto column = static_cast<Eigen::Index>(fault.joint);
  FaultLaw<N, Scalar> law;
  law.joint = fault.joint;
  law.known = fault.confidence >= confidence;
  law.sign_width = kWidths * scales.friction[fault.joint].width;
  const Scalar size = surely(fault.size, fault.deviation * fault.deviation);
  switch (fault.kind) {
    case FaultKind::kFriction:
      law.own = friction_law(state.joints[fault.joint].own).cwiseProduct(scales.own.col(column));
      break;
    case FaultKind::kLostTorque:
      law.own[kTorqueRegressor] = std::clamp(size, -kMostGained, kMostLost);
      break;
    case FaultKind::kOffset:
      law.own[kOneRegressor] = size;
      break;
    case FaultKind::kPayload: {
      const auto fit = fit_of(state.tip);
      law.of_body = true;
      for (int i = 0; i < kTipParameters; ++i) {
        law.body[i] = scales.tip[i] * surely(fit.theta[i], fit.covariance(i, i));
      }
      break;
    }
    default:
      law.known = false;
  }
  law.known = law.known && all_finite(law.own) && all_finite(law.body);
  return law;
}

}  // namespace offnominal::detail
