#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <offnominal/diagnosis/isolation_block.hpp>
#include <offnominal/diagnosis/known_friction.hpp>
#include <offnominal/monitor.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

// A usual size of a fault, in units of the joint's largest threshold; of a lost torque, as a share.
inline constexpr double kPriorTorque = 1.5;
inline constexpr double kPriorShare = 0.3;

// Sizes that turn scaled parameters into units; constants of a robot.
template <int N, typename Scalar>
struct IsolationScales {
  OwnValues<N, Scalar> own = no_values<OwnValues<N, Scalar>>();
  Vector<kTipParameters, Scalar> tip = Vector<kTipParameters, Scalar>::Ones();
  PerJoint<N, Scalar> thresholds{};  // largest of each joint, N m or N
  PerJoint<N, Scalar> speeds{};      // largest velocities, rad/s or m/s; 1 where there is no limit
  Scalar reach_m = Scalar(0.6);      // of a payload's centre from the last link's frame, at most
  Scalar alpha{};                    // of the monitor, 1/s
  // The most that can be lost of each joint's friction, dry and viscous, and of the last link, kg.
  PerJoint<N, KnownFriction<Scalar>> friction{};
  Scalar last_mass = std::numeric_limits<Scalar>::max();
};

namespace detail {

// Point masses that the model has beside the last link, kg.
template <int N, typename Scalar>
[[nodiscard]] Scalar point_mass_of_last(const Chain<N, Scalar>& chain) {
  Scalar mass{};
  for (const Effect<Scalar>& effect : chain.effects.view()) {
    if (effect.joint + 1U != chain.joints.size()) continue;
    visit_effect(effect.kind, [&]<typename E>() {
      if constexpr (action_of<E>() == EffectAction::kPointMass) mass += effect.parameters[0];
    });
  }
  return mass;
}

}  // namespace detail

// Those of the robot that a monitor of that configuration watches; `sign_width` is
// IsolationConfig's, rad/s or m/s.
template <int N, typename Scalar>
[[nodiscard]] IsolationScales<N, Scalar> scales_of(
    const MonitorConfig<N, Scalar, TorqueSpace>& watched, Scalar sign_width) {
  IsolationScales<N, Scalar> scales;
  const std::size_t count = watched.chain.joints.size();
  size_for(count, scales.thresholds, scales.speeds);
  scales.alpha = watched.estimator.alpha;
  scales.own.resize(kOwnRegressors, static_cast<Eigen::Index>(count));
  Scalar mass{};
  for (std::size_t i = 0; i < count; ++i) {
    const Joint<Scalar>& joint = watched.chain.joints[i];
    const JointBound<Scalar>& bound = watched.bound.joints[i];
    const Scalar threshold = largest_value(bound) + 2 * scales.alpha * bound.momentum_error;
    scales.thresholds[i] = threshold;
    const Scalar torque = static_cast<Scalar>(kPriorTorque) * threshold;
    constexpr Scalar kFast = Scalar(100);  // no speed limit
    const Scalar speed = joint.max_velocity < kFast ? joint.max_velocity : Scalar(1);
    scales.speeds[i] = speed;
    scales.own.col(static_cast<Eigen::Index>(i)) << torque, torque / speed,
        static_cast<Scalar>(kPriorShare), torque;
    mass += joint.mass_kg;
  }
  constexpr Scalar kShareOfMass = Scalar(0.1);
  constexpr Scalar kDistanceM = Scalar(0.15);  // of a payload from the last joint
  scales.tip.setConstant(kShareOfMass * mass * kDistanceM);
  scales.tip[0] = kShareOfMass * mass;
  scales.friction = known_friction<N, Scalar>(watched.chain, sign_width);
  // Of a tool, beyond a link of the size that its centre of mass tells of.
  const Joint<Scalar>& last = watched.chain.joints[count - 1];
  const auto& centre = last.centre_of_mass_m;
  scales.reach_m = Scalar(0.6) + 2 * Vector<3, Scalar>(centre[0], centre[1], centre[2]).norm();
  scales.last_mass = last.mass_kg + detail::point_mass_of_last(watched.chain);
  return scales;
}

}  // namespace offnominal
