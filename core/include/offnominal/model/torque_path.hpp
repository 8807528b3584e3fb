#pragma once

#include <Eigen/Core>
#include <offnominal/model/rigid_body_model.hpp>

// The way of the torque from the drive to the load. Per joint,
//   tau = told_per_given (load + by_size |load| + by_load load + torque)
// with tau: what the drive is told to give and what a log says; torque: sum of the effects that do
// not depend on the load; load: M ddq + V dq + G, what the joint passes on to all that has inertia
// or weight. Reflected inertia counts as load, whichever side of the gear it sits on: only then
// does each joint's equation close by itself, so that the acceleration follows from the torque
// without an iteration. What that is off where a rotor sits before the gear is the friction per
// load times the torque that accelerates the rotor.
//
// |by_size| < 1 + by_load, hence load has the sign of what is left for it, and the equation has
// exactly one solution in either direction: drive_torque() and load_torque() are each other's
// inverse. Non-finite input gives non-finite output.

namespace offnominal {

// What the effects of every joint are at one instant, whatever the torque.
template <int N, typename Scalar>
struct JointEffects {
  Vector<N, Scalar> torque = zeros<N, Scalar>();  // N m or N
  // effects::LoadFriction, of all effects together; by_size is signed by the direction.
  Vector<N, Scalar> friction_by_size = zeros<N, Scalar>();
  Vector<N, Scalar> friction_by_load = zeros<N, Scalar>();
};

namespace detail {

// What the motor of that number does. Out of line, as the next one: few chains have such effects,
// and where there are none this shall cost no more than the question.
template <int N, typename Scalar>
[[nodiscard]] EIGEN_DONT_INLINE JointInstant<Scalar> motor_instant(
    const RigidBodyModel<N, Scalar>& model, const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
    Eigen::Index motor, double time_s) {
  JointInstant<Scalar> instant{model.motor_offset_rad[motor], Scalar(0), time_s};
  for (Eigen::Index joint = 0; joint < q.size(); ++joint) {
    instant.q += model.motor_per_joint(motor, joint) * q[joint];
    instant.dq += model.motor_per_joint(motor, joint) * dq[joint];
  }
  return instant;
}

// What a torque of that motor is at the joints.
template <int N, typename Scalar>
EIGEN_DONT_INLINE void add_motor_torque(const RigidBodyModel<N, Scalar>& model, Eigen::Index motor,
                                        Scalar torque, Vector<N, Scalar>& sum) {
  for (Eigen::Index joint = 0; joint < sum.size(); ++joint) {
    sum[joint] += torque * model.motor_per_joint(motor, joint);
  }
}

}  // namespace detail

// time_s: since the run's origin.
template <int N, typename Scalar>
[[nodiscard]] JointEffects<N, Scalar> joint_effects(const RigidBodyModel<N, Scalar>& model,
                                                    const Vector<N, Scalar>& q,
                                                    const Vector<N, Scalar>& dq, double time_s) {
  JointEffects<N, Scalar> sum;
  size_for(model.bodies.size(), sum.torque, sum.friction_by_size, sum.friction_by_load);
  for (const Effect<Scalar>& effect : model.torque_effects.view()) {
    const auto joint = static_cast<Eigen::Index>(effect.joint);
    JointInstant<Scalar> instant{q[joint], dq[joint], time_s};
    if (effect.of_motor) instant = detail::motor_instant(model, q, dq, joint, time_s);
    Scalar torque{};
    visit_effect(effect.kind, [&]<typename E>() {
      if constexpr (kHasSource<E>) instant.source_dq = dq[source_joint<E>(effect.parameters)];
      if constexpr (requires { E::torque(effect.parameters, instant); }) {
        torque = E::torque(effect.parameters, instant);
      } else if constexpr (requires { E::friction_per_load(effect.parameters, instant); }) {
        const auto friction = E::friction_per_load(effect.parameters, instant);
        sum.friction_by_size[joint] += friction.by_size;
        sum.friction_by_load[joint] += friction.by_load;
      }
    });
    if (effect.of_motor) {
      detail::add_motor_torque(model, joint, torque, sum.torque);
    } else {
      sum.torque[joint] += torque;
    }
  }
  return sum;
}

// Sum of the model's torque effects per joint that do not depend on the load, N m or N.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> effect_torque(const RigidBodyModel<N, Scalar>& model,
                                              const Vector<N, Scalar>& q,
                                              const Vector<N, Scalar>& dq, double time_s) {
  return joint_effects(model, q, dq, time_s).torque;
}

// What the drive has to be told for this load, N m or N per joint.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> drive_torque(const RigidBodyModel<N, Scalar>& model,
                                             const JointEffects<N, Scalar>& effects,
                                             const Vector<N, Scalar>& load) {
  if (!model.has_torque_path) return load + effects.torque;
  return model.told_per_given.cwiseProduct(
      load + effects.friction_by_size.cwiseProduct(load.cwiseAbs()) +
      effects.friction_by_load.cwiseProduct(load) + effects.torque);
}

namespace detail {

// d (given torque) / d (load) on the side of zero where `load` lies.
template <typename Scalar>
[[nodiscard]] inline Scalar given_per_load(Scalar by_size, Scalar by_load, Scalar load) {
  return Scalar(1) + by_load + (load < Scalar(0) ? -by_size : by_size);
}

}  // namespace detail

// What is left for the load of what the drive is told, N m or N per joint.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> load_torque(const RigidBodyModel<N, Scalar>& model,
                                            const JointEffects<N, Scalar>& effects,
                                            const Vector<N, Scalar>& tau) {
  if (!model.has_torque_path) return tau - effects.torque;
  Vector<N, Scalar> load = tau.cwiseQuotient(model.told_per_given) - effects.torque;
  for (Eigen::Index i = 0; i < load.size(); ++i) {
    load[i] /=
        detail::given_per_load(effects.friction_by_size[i], effects.friction_by_load[i], load[i]);
  }
  return load;
}

// d drive_torque / d load at this load: what the drive has to be told per unit of load more.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> told_per_load(const RigidBodyModel<N, Scalar>& model,
                                              const JointEffects<N, Scalar>& effects,
                                              const Vector<N, Scalar>& load) {
  Vector<N, Scalar> per_load = model.told_per_given;
  if (!model.has_torque_path) return per_load;
  for (Eigen::Index i = 0; i < load.size(); ++i) {
    per_load[i] *=
        detail::given_per_load(effects.friction_by_size[i], effects.friction_by_load[i], load[i]);
  }
  return per_load;
}

}  // namespace offnominal
