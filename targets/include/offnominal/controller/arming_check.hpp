#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/controller/fault.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/sample.hpp>

// What a controller asks of arm, reference and configuration before it commands a torque.

namespace offnominal::controller {

// kNone for a reference that the joints can follow; otherwise NonFiniteReference or
// kReferenceOutOfRange.
template <int N, typename Scalar>
[[nodiscard]] Fault check_reference(const Reference<N, Scalar>& reference,
                                    const Chain<N, Scalar>& chain,
                                    const PositionRange<N, Scalar>& range) {
  if (!all_finite(reference.q) || !all_finite(reference.dq) || !all_finite(reference.ddq)) {
    return fault_of(Status::kNonFiniteReference);
  }
  for (Eigen::Index i = 0; i < reference.q.size(); ++i) {
    const Scalar most = chain.joints[static_cast<std::size_t>(i)].max_velocity;
    const bool inside = reference.q[i] >= range.lowest[i] && reference.q[i] <= range.highest[i] &&
                        std::fabs(reference.dq[i]) <= most;
    if (!inside) return Fault::kReferenceOutOfRange;
  }
  return Fault::kNone;
}

// Whether a difference is a number, and no larger than this.
template <typename Scalar>
[[nodiscard]] bool is_within(Scalar difference, Scalar most) {
  return is_finite(difference) && std::fabs(difference) <= most;
}

// Whether torque may be commanded that starts at this sample, with `reference` at time 0, which
// check_reference() has passed: kNone, or why not.
template <int N, typename Scalar>
[[nodiscard]] Fault check_arming(const ControlConfig<N, Scalar>& config,
                                 const Chain<N, Scalar>& chain,
                                 const JointSample<N, Scalar>& sample,
                                 const Reference<N, Scalar>& reference) {
  for (std::size_t j = 0; j < config.gains.kp.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    if (config.gains.kp[j] <= 0 || config.gains.kd[j] <= 0) return Fault::kNoGains;
    const Scalar limit = chain.joints[j].max_torque;
    if (!is_finite(limit) || limit >= std::numeric_limits<Scalar>::max())
      return Fault::kNoTorqueLimit;
    const Scalar window = config.arming.position_window[j];
    if (!is_within(reference.q[i] - sample.q[i], window)) return Fault::kReferenceFarFromArm;
    const Scalar speed = config.arming.speed[j];
    if (!is_within(sample.dq[i], speed)) return Fault::kArmMoving;
    if (!is_within(reference.dq[i] - sample.dq[i], speed)) return Fault::kReferenceMoving;
  }
  return Fault::kNone;
}

}  // namespace offnominal::controller
