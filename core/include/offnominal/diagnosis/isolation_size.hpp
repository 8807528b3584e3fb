#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_scales.hpp>
#include <offnominal/diagnosis/isolation_state.hpp>

// How large the fault is that is told.

namespace offnominal::detail {

// Size, deviation and what it explains of the squares, of the hypothesis that is told.
template <int N, typename Scalar>
struct Measure {
  Scalar size{};
  Scalar deviation{};
  Scalar explained{};
};

// Of a size with the variance of its regression. Where it leaves more of the squares than noise
// does, that is an error of the hypothesis; and one of its shape it may always have.
template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_from(Scalar size, Scalar variance, Scalar explained,
                                              Scalar squares, std::uint32_t observations) {
  constexpr auto kShapeError = static_cast<Scalar>(0.04);
  const Scalar left =
      (squares - explained) / static_cast<Scalar>(std::max(observations, std::uint32_t{1}));
  const Scalar shape = kShapeError * size;
  return {size, std::sqrt(std::max(left, Scalar(1)) * variance + shape * shape), explained};
}

// Of a hypothesis of one parameter among a joint's own.
template <int Which, int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_one(const IsolationState<N, Scalar>& state,
                                                const IsolationScales<N, Scalar>& scales,
                                                std::size_t joint) {
  const JointEvidence<Scalar>& seen = state.joints[joint];
  const auto fit = fit_of(part_of<Which>(seen.own));
  const Scalar scale = scales.own(Which, static_cast<Eigen::Index>(joint));
  return measure_from<N, Scalar>(scale * fit.theta[0], scale * scale * fit.covariance(0, 0),
                                 fit.explained, seen.squares, state.blocks);
}

// Dry and viscous together, at the mean speed.
template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_friction(const IsolationState<N, Scalar>& state,
                                                     const IsolationScales<N, Scalar>& scales,
                                                     std::size_t joint) {
  const JointEvidence<Scalar>& seen = state.joints[joint];
  const auto fit = fit_of(part_of<kSignRegressor, kVelocityRegressor>(seen.own));
  const auto column = static_cast<Eigen::Index>(joint);
  const Scalar speed = mean_speed(state, joint);
  const Scalar dry = scales.own(kSignRegressor, column);
  const Scalar viscous = scales.own(kVelocityRegressor, column) * speed;
  const Scalar variance = dry * dry * fit.covariance(0, 0) +
                          2 * dry * viscous * fit.covariance(0, 1) +
                          viscous * viscous * fit.covariance(1, 1);
  return measure_from<N, Scalar>(dry * fit.theta[0] + viscous * fit.theta[1], variance,
                                 fit.explained, seen.squares, state.blocks);
}

// Whether a payload of that mass may be one: a mass that may be none is another torque that looks
// like it, an encoder that lies for one, and compensated it would push as a weight does. A link
// that has lost some of its own, or a tool, has no more than `there`.
template <int N, typename Scalar>
[[nodiscard]] bool is_body(const Measure<N, Scalar>& mass, Scalar there) {
  constexpr auto kTolerance = static_cast<Scalar>(1.25);
  constexpr auto kSurely = static_cast<Scalar>(3);  // deviations
  if (mass.size > 0) return mass.size > kSurely * mass.deviation;
  return -mass.size > kSurely * mass.deviation && -mass.size < kTolerance * there;
}

// Of any torque on the joints up to `last`: the largest.
template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of_torque(const IsolationState<N, Scalar>& state,
                                                   std::size_t first, std::size_t last) {
  Measure<N, Scalar> measure;
  for (std::size_t i = first; i <= last; ++i) {
    const JointEvidence<Scalar>& joint = state.joints[i];
    measure.explained += joint.squares;
    if (Eigen::numext::abs(joint.largest) <= Eigen::numext::abs(measure.size)) continue;
    measure.size = joint.largest;
    measure.deviation = std::sqrt(joint.any.variance);
  }
  return measure;
}

template <int N, typename Scalar>
[[nodiscard]] Measure<N, Scalar> measure_of(const IsolationState<N, Scalar>& state,
                                            const IsolationScales<N, Scalar>& scales,
                                            FaultKind kind, std::size_t joint) {
  const std::size_t last = state.joints.size() - 1;
  switch (kind) {
    case FaultKind::kFriction:
      return measure_of_friction(state, scales, joint);
    case FaultKind::kLostTorque:
      return measure_of_one<kTorqueRegressor>(state, scales, joint);
    case FaultKind::kOffset:
      return measure_of_one<kOneRegressor>(state, scales, joint);
    case FaultKind::kPayload: {
      const auto fit = fit_of(state.tip);
      const Scalar scale = scales.tip[0];
      const auto joints = static_cast<std::uint32_t>(state.joints.size());
      return measure_from<N, Scalar>(scale * fit.theta[0], scale * scale * fit.covariance(0, 0),
                                     fit.explained, measure_of_torque(state, 0, last).explained,
                                     joints * state.blocks);
    }
    case FaultKind::kContact:
      return measure_of_torque(state, 0, joint);
    case FaultKind::kLockedJoint: {
      Measure<N, Scalar> measure = measure_of_torque(state, joint, joint);
      const JointEvidence<Scalar>& seen = state.joints[joint];
      if (Eigen::numext::abs(seen.largest_held) > Eigen::numext::abs(measure.size)) {
        measure.size = seen.largest_held;
        measure.deviation = std::sqrt(seen.held.variance);
      }
      return measure;
    }
    case FaultKind::kEncoderJump: {
      Measure<N, Scalar> measure = measure_of_torque(state, 0, last);
      measure.size = state.encoders[joint].jump;
      measure.deviation = state.encoders[joint].jerk[2];
      return measure;
    }
    case FaultKind::kEncoderStuck:
    case FaultKind::kUnknown:
      break;
  }
  return {Scalar(0), Scalar(0), measure_of_torque(state, 0, last).explained};
}

}  // namespace offnominal::detail
