#pragma once

#include <cmath>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/model/two_link_closed_form.hpp"
#include "support/seed.hpp"

// A two-link arm that moves along given sines; the torque is what the closed form needs for it,
// less what a fault adds to the acceleration. What a monitor is told about it, and its limits.

namespace offnominal::test {

inline constexpr int kArmJoints = 2;
inline constexpr int kArmHidden = 12;
inline constexpr double kMaxPosition = 2.5;
inline constexpr double kMaxVelocity = 8;
inline constexpr double kMaxTorque = 80;

template <typename Scalar>
MonitorConfig<kArmJoints, Scalar> arm_config() {
  const TwoLinkClosedForm arm;
  MonitorConfig<kArmJoints, Scalar> config;
  config.chain.gravity_m_s2 = {0, static_cast<Scalar>(-arm.gravity), 0};
  auto& [first, second] = config.chain.joints;
  first.mass_kg = static_cast<Scalar>(arm.mass1);
  first.centre_of_mass_m = {static_cast<Scalar>(arm.length1), 0, 0};
  second.origin_m = first.centre_of_mass_m;
  second.mass_kg = static_cast<Scalar>(arm.mass2);
  second.centre_of_mass_m = {static_cast<Scalar>(arm.length2), 0, 0};
  for (Joint<Scalar>& joint : config.chain.joints) {
    joint.min_position = static_cast<Scalar>(-kMaxPosition);
    joint.max_position = static_cast<Scalar>(kMaxPosition);
    joint.max_velocity = static_cast<Scalar>(kMaxVelocity);
    joint.max_torque = static_cast<Scalar>(kMaxTorque);
  }
  config.estimator.hidden_units = kArmHidden;
  config.bound.offset = 1;
  config.max_compensation = {50, 50};
  return config;
}

template <typename Scalar>
class WatchedArm {
 public:
  using Watch = Monitor<kArmJoints, kArmHidden, Scalar>;
  using Sample = JointSample<kArmJoints, Scalar>;

  // Where it is now.
  Sample sample() const { return sample_at(fault_now_); }

  // Moves on by period_s; the fault adds (fault, -fault) to the acceleration from now on.
  Sample move(double period_s, double fault) {
    time_s_ += period_s;
    fault_now_ = fault;
    return sample();
  }

 private:
  Sample sample_at(double fault) const {
    const double t = time_s_;
    const Eigen::Vector2d q(0.4 * std::sin(2 * t), 0.5 * std::sin(3 * t + 1));
    const Eigen::Vector2d dq(0.8 * std::cos(2 * t), 1.5 * std::cos(3 * t + 1));
    const Eigen::Vector2d ddq(-1.6 * std::sin(2 * t), -4.5 * std::sin(3 * t + 1));
    const Eigen::Vector2d tau = arm_.torque(q, dq, ddq - Eigen::Vector2d(fault, -fault));
    return {q.cast<Scalar>(), dq.cast<Scalar>(), tau.cast<Scalar>()};
  }

  TwoLinkClosedForm arm_;
  double time_s_ = 0;
  double fault_now_ = 0;
};

}  // namespace offnominal::test
