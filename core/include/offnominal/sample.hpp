#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/finite.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// What was measured at one tick. Positions are continuous: an encoder that wraps is unwrapped
// before it comes here.
template <int N, typename Scalar>
struct JointSample {
  Vector<N, Scalar> q = zeros<N, Scalar>();    // rad or m
  Vector<N, Scalar> dq = zeros<N, Scalar>();   // rad/s or m/s
  Vector<N, Scalar> tau = zeros<N, Scalar>();  // really applied, N m or N, not commanded
};

// The torque between two samples, which the samples alone do not say.
enum class TorqueSignal : std::uint8_t {
  kSampled = 0,  // linear from one sample to the next
  kHeld = 1,  // over the whole tick what the sample at its end says: a drive with zero-order hold
};

// A measured torque may be above a joint's max_torque by this share of it: max_torque bounds what
// is commanded, and a healthy drive that gives that much says a little more or less. Current loops
// overshoot by up to some 10 %, ripple and offsets are some per cent of full scale; the smallest of
// the usual errors of scale, the peak of a current taken for its root mean square, is 1.41.
inline constexpr double kTorqueMargin = 0.2;

// kOk where every number is finite and inside the joint's limits, a torque within kTorqueMargin
// beyond; otherwise the first fault, with non-finite numbers before ranges, and another number of
// joints before all.
template <int N, typename Scalar>
[[nodiscard]] Status validate(const JointSample<N, Scalar>& sample,
                              const PerJoint<N, Joint<Scalar>>& joints) {
  if constexpr (N == kRuntimeJoints) {
    const auto count = static_cast<Eigen::Index>(joints.size());
    if (sample.q.size() != count || sample.dq.size() != count || sample.tau.size() != count) {
      return Status::kWrongJointCount;
    }
  }
  if (!all_finite(sample.q)) return Status::kNonFinitePosition;
  if (!all_finite(sample.dq)) return Status::kNonFiniteVelocity;
  if (!all_finite(sample.tau)) return Status::kNonFiniteTorque;
  // On this side of the comparison: max_torque may be the largest number that there is.
  constexpr auto kShare = static_cast<Scalar>(1 / (1 + kTorqueMargin));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const Joint<Scalar>& joint = joints[i];
    if (sample.q[index] < joint.min_position || sample.q[index] > joint.max_position) {
      return Status::kPositionOutOfRange;
    }
    if (std::fabs(sample.dq[index]) > joint.max_velocity) return Status::kVelocityOutOfRange;
    if (std::fabs(sample.tau[index]) * kShare > joint.max_torque) return Status::kTorqueOutOfRange;
  }
  return Status::kOk;
}

}  // namespace offnominal
