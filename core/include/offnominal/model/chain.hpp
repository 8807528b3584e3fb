#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <offnominal/finite.hpp>
#include <offnominal/joint_count.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/model/quantity.hpp>
#include <offnominal/status.hpp>

// The description of an open serial chain as plain data: what a robot file holds and what code
// generation writes as a constant. RigidBodyModel (rigid_body_model.hpp) is made from it.

namespace offnominal {

inline constexpr int kEffectsPerJoint = 8;

// One joint and the link behind it. The joint's frame sits at the joint, in the link before it;
// the link's frame moves with the joint and coincides with the joint's frame at q = 0.
template <typename Scalar>
struct Joint {
  JointType type = JointType::kRevolute;
  std::array<Scalar, 3> axis{0, 0, 1};      // unit vector, joint's frame
  std::array<Scalar, 3> origin_m{0, 0, 0};  // of the joint's frame, in the frame before it
  // Turns coordinates of the joint's frame into those of the frame before it, row by row.
  std::array<Scalar, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};

  Scalar mass_kg = 1;                               // > 0
  std::array<Scalar, 3> centre_of_mass_m{0, 0, 0};  // link's frame
  // xx, yy, zz, xy, xz, yz about the centre of mass, axes of the link's frame. All zero: a point
  // mass. Otherwise principal moments that a real body can have: positive, none above the sum of
  // the other two; one of them is zero for a rod without thickness.
  std::array<Scalar, 6> inertia_kg_m2{};

  // The sample range that is believed: rad or m; rad/s or m/s; N m or N. Outside of it a sample is
  // refused. max_torque also bounds what accommodation may command.
  Scalar min_position = -std::numeric_limits<Scalar>::max();
  Scalar max_position = std::numeric_limits<Scalar>::max();
  Scalar max_velocity = std::numeric_limits<Scalar>::max();
  Scalar max_torque = std::numeric_limits<Scalar>::max();
};

// Between motors and joints: q_m = A q + offset, dq_m = A dq, tau = A^T tau_m. Only effects of
// motors act by it; samples and torques are of the joints.
template <int N, typename Scalar>
struct Transmission {
  static constexpr auto kMost = static_cast<std::size_t>(kMostJoints<N>);
  // A, row by row, kMost numbers each: rad of the motor per rad or m of each joint.
  std::array<Scalar, kMost* kMost> motor_per_joint = [] {
    std::array<Scalar, kMost * kMost> identity{};
    for (std::size_t i = 0; i < identity.size(); i += kMost + 1) identity[i] = 1;
    return identity;
  }();
  std::array<Scalar, kMost> motor_offset_rad{};
};

template <int N, typename Scalar>
struct Chain {
  static_assert(N >= 1 || N == kRuntimeJoints, "a chain has at least one joint");
  PerJoint<N, Joint<Scalar>> joints{};                                   // as many as the chain has
  std::array<Scalar, 3> gravity_m_s2{0, 0, static_cast<Scalar>(-9.81)};  // base frame
  EffectList<Scalar, kEffectsPerJoint * kMostJoints<N>> effects{};
  Transmission<N, Scalar> transmission{};
};

namespace detail {

// Sylvester's criterion on the inertia tensor J, and on tr(J)/2 I - J, the second-moment matrix of
// the mass, which no body can have negative (P. M. Wensing et al., IEEE RA-L 3(1), 2018). A plate
// makes the second one singular and a thin rod both of them, hence the tolerance.
template <typename Scalar>
[[nodiscard]] inline bool inertia_possible(const std::array<Scalar, 6>& inertia) {
  const auto leading_minors_above = [](Scalar xx, Scalar yy, Scalar zz, Scalar xy, Scalar xz,
                                       Scalar yz, Scalar floor) {
    const Scalar second = xx * yy - xy * xy;
    const Scalar third = zz * second - xz * (xz * yy - xy * yz) + yz * (xz * xy - xx * yz);
    return xx > floor && second > floor && third > floor;
  };
  const auto& [xx, yy, zz, xy, xz, yz] = inertia;
  const Scalar scale = std::fmax(std::fabs(xx), std::fmax(std::fabs(yy), std::fabs(zz)));
  if (scale <= 0) return xy == 0 && xz == 0 && yz == 0;
  const Scalar s = 1 / scale;
  if (!is_finite(s)) return false;
  const Scalar half = (xx + yy + zz) * s / 2;
  const Scalar tolerance = 100 * std::numeric_limits<Scalar>::epsilon();
  // A rod has one zero moment in J, but two in the second one, whose determinant is rounding only.
  return leading_minors_above(xx * s + tolerance, yy * s + tolerance, zz * s + tolerance, xy * s,
                              xz * s, yz * s, Scalar(0)) &&
         leading_minors_above(half - xx * s + tolerance, half - yy * s + tolerance,
                              half - zz * s + tolerance, -xy * s, -xz * s, -yz * s, -tolerance);
}

template <typename Scalar>
[[nodiscard]] inline bool is_rotation(const std::array<Scalar, 9>& r) {
  const Scalar tolerance = 1000 * std::numeric_limits<Scalar>::epsilon();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Scalar dot =
          r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] + r[3 * i + 2] * r[3 * j + 2];
      const Scalar error = std::fabs(dot - (i == j ? Scalar(1) : Scalar(0)));
      if (!is_finite(error) || error > tolerance) return false;
    }
  }
  const Scalar determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) -
                             r[1] * (r[3] * r[8] - r[5] * r[6]) +
                             r[2] * (r[3] * r[7] - r[4] * r[6]);
  return determinant > 0;
}

}  // namespace detail

// kOk where the joint is usable. NaN fails every check.
template <typename Scalar>
[[nodiscard]] inline Status validate(const Joint<Scalar>& joint) {
  const Scalar axis_norm = std::sqrt(joint.axis[0] * joint.axis[0] + joint.axis[1] * joint.axis[1] +
                                     joint.axis[2] * joint.axis[2]);
  const bool unit_axis = is_finite(axis_norm) &&
                         std::fabs(axis_norm - 1) <= 1000 * std::numeric_limits<Scalar>::epsilon();
  if (!unit_axis) return Status::kInvalidAxis;
  if (!detail::is_rotation(joint.rotation)) return Status::kInvalidRotation;
  if (!all_finite(joint.origin_m)) return Status::kInvalidOrigin;
  if (!is_finite(joint.mass_kg) || joint.mass_kg <= 0) return Status::kInvalidMass;
  if (!all_finite(joint.centre_of_mass_m)) return Status::kInvalidInertia;
  if (!all_finite(joint.inertia_kg_m2) || !detail::inertia_possible(joint.inertia_kg_m2)) {
    return Status::kInvalidInertia;
  }
  const bool limits_are_numbers = !is_nan(joint.min_position) && !is_nan(joint.max_position) &&
                                  !is_nan(joint.max_velocity) && !is_nan(joint.max_torque);
  const bool limits_ok = limits_are_numbers && joint.min_position < joint.max_position &&
                         joint.max_velocity > 0 && joint.max_torque > 0;
  return limits_ok ? Status::kOk : Status::kInvalidLimit;
}

// kOk where every joint, effect and the gravity vector are usable; otherwise the first fault found.
// kTooManyEffects: the list's size is above its capacity. kWrongJointCount: no joint. A
// transmission with a number that is not finite is kInvalidEffect, as it serves effects alone.
template <int N, typename Scalar>
[[nodiscard]] inline Status validate(const Chain<N, Scalar>& chain) {
  if constexpr (N == kRuntimeJoints) {
    if (chain.joints.empty()) return Status::kWrongJointCount;
  }
  if (!all_finite(chain.gravity_m_s2)) return Status::kInvalidGravity;
  for (const Joint<Scalar>& joint : chain.joints) {
    const Status status = validate(joint);
    if (status != Status::kOk) return status;
  }
  if (chain.effects.size > chain.effects.items.size()) return Status::kTooManyEffects;
  if (!all_finite(chain.transmission.motor_per_joint) ||
      !all_finite(chain.transmission.motor_offset_rad)) {
    return Status::kInvalidEffect;
  }
  const auto joints = static_cast<int>(chain.joints.size());
  std::array<Scalar, static_cast<std::size_t>(kMostJoints<N>)> friction_per_load{};
  for (const Effect<Scalar>& effect : chain.effects.view()) {
    const bool usable =
        effect.joint < joints && parameters_valid(effect) && source_joint_valid(effect, joints);
    if (!usable || (effect.of_motor && !motor_may_have(effect.kind))) return Status::kInvalidEffect;
    Scalar& of_joint = friction_per_load[effect.joint];
    of_joint += most_friction_per_load(effect);
    const double most = effects::LoadDependentFriction::kMostFactor;
    if (!is_finite(of_joint) || of_joint > static_cast<Scalar>(most)) return Status::kInvalidEffect;
  }
  return Status::kOk;
}

}  // namespace offnominal
