// What comes in over the bus, tick by tick.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "rig.hpp"

namespace offnominal::cortex_m {

// The joints on a smooth path with the torque that the model asks for there, and `extra` of each
// joint's largest torque beside it.
inline JointSample<kJoints, Scalar> on_path(const Controller& controller, std::uint32_t tick,
                                            Scalar extra) {
  const auto& joints = controller.monitor().config().chain.joints;
  JointSample<kJoints, Scalar> sample;
  Vector<kJoints, Scalar> ddq;
  const Scalar t = static_cast<Scalar>(tick) * static_cast<Scalar>(kPeriodUs * 1e-6);
  for (Eigen::Index i = 0; i < kJoints; ++i) {
    const Scalar w = Scalar(2) + static_cast<Scalar>(i);
    const Scalar centre =
        i == 3 ? Scalar(-1.5) : Scalar(0);  // joint 4 of the arm bends one way only
    sample.q[i] = centre + Scalar(0.2) * std::sin(w * t);
    sample.dq[i] = Scalar(0.2) * w * std::cos(w * t);
    ddq[i] = Scalar(-0.2) * w * w * std::sin(w * t);
  }
  sample.tau = inverse_dynamics(controller.monitor().model(), sample.q, sample.dq, ddq,
                                static_cast<double>(t));
  for (Eigen::Index i = 0; i < kJoints; ++i) {
    const Scalar most = joints[static_cast<std::size_t>(i)].max_torque;
    sample.tau[i] = std::fmax(-most, std::fmin(most, sample.tau[i] + extra * most));
  }
  return sample;
}

// xorshift32 (G. Marsaglia, 2003): the search repeats.
class Random {
 public:
  [[nodiscard]] std::uint32_t bits() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_;
  }
  // In [0, 1).
  [[nodiscard]] Scalar unit() { return static_cast<Scalar>(bits() >> 8U) / Scalar(1 << 24); }
  // Either sign, any order of magnitude from denormal to `most`, and most itself often.
  [[nodiscard]] Scalar any_size(Scalar most) {
    const Scalar sign = (bits() & 1U) != 0 ? Scalar(1) : Scalar(-1);
    if (bits() % 4 == 0) return sign * most;
    const Scalar decades = unit() * Scalar(std::numeric_limits<Scalar>::max_exponent10 + 6);
    return sign * most * std::pow(Scalar(10), -decades);
  }

 private:
  std::uint32_t state_ = 2463534242U;
};

// Anything that the joints' limits let through, frames too.
inline JointSample<kJoints, Scalar> anything(const Controller& controller, Random& random) {
  const auto& joints = controller.monitor().config().chain.joints;
  constexpr Scalar kMostOfAFrame = 31;
  JointSample<kJoints, Scalar> sample;
  for (Eigen::Index i = 0; i < kJoints; ++i) {
    const auto& joint = joints[static_cast<std::size_t>(i)];
    const Scalar middle = (joint.min_position + joint.max_position) / 2;
    const Scalar reach = std::fmin(kMostOfAFrame, (joint.max_position - joint.min_position) / 2);
    sample.q[i] = middle + random.any_size(reach * Scalar(0.999));
    sample.dq[i] = random.any_size(std::fmin(kMostOfAFrame, joint.max_velocity * Scalar(0.999)));
    sample.tau[i] = random.any_size(joint.max_torque);
  }
  return sample;
}

}  // namespace offnominal::cortex_m
