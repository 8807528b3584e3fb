#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <offnominal/model/chain.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

namespace detail {

template <typename Scalar>
[[nodiscard]] inline Matrix<3, 3, Scalar> cross_matrix(const Vector<3, Scalar>& v) {
  Matrix<3, 3, Scalar> m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace detail

// Mass, first moment and inertia of a body about the origin of its link's frame. Bodies add.
template <typename Scalar>
struct SpatialInertia {
  Scalar mass{};                                                // kg
  Vector<3, Scalar> first_moment = Vector<3, Scalar>::Zero();   // kg m
  Matrix<3, 3, Scalar> inertia = Matrix<3, 3, Scalar>::Zero();  // kg m^2

  SpatialInertia& operator+=(const SpatialInertia& other) {
    mass += other.mass;
    first_moment += other.first_moment;
    inertia += other.inertia;
    return *this;
  }
  void add_point_mass(Scalar point_mass, const Vector<3, Scalar>& at) {
    mass += point_mass;
    first_moment += point_mass * at;
    inertia +=
        point_mass * (at.squaredNorm() * Matrix<3, 3, Scalar>::Identity() - at * at.transpose());
  }
};

// A chain made ready for the recursions: constant products are formed once, inertial effects are
// part of the bodies. Immutable after make_model().
template <int N, typename Scalar>
struct RigidBodyModel {
  struct Body {
    JointType type = JointType::kRevolute;
    Vector<3, Scalar> axis = Vector<3, Scalar>::UnitZ();
    Vector<3, Scalar> origin = Vector<3, Scalar>::Zero();
    // Child to parent: fixed + sin(q) * sine + cos(q) * cosine (Rodrigues' formula behind the
    // joint's own rotation). A prismatic joint has `fixed` only.
    Matrix<3, 3, Scalar> fixed = Matrix<3, 3, Scalar>::Identity();
    Matrix<3, 3, Scalar> sine = Matrix<3, 3, Scalar>::Zero();
    Matrix<3, 3, Scalar> cosine = Matrix<3, 3, Scalar>::Zero();
    Vector<3, Scalar> slide =
        Vector<3, Scalar>::Zero();  // motion of a prismatic joint, parent's frame
    SpatialInertia<Scalar> link;
    Scalar reflected_inertia{};
  };
  PerJoint<N, Body> bodies{};
  Vector<3, Scalar> gravity = Vector<3, Scalar>::Zero();
  // Those with a torque() or a friction_per_load() only.
  EffectList<Scalar, kEffectsPerJoint * kMostJoints<N>> torque_effects{};
  // Torque that the drive is told, and that a log says, per torque that it gives; product of the
  // effects with a told_per_given().
  Vector<N, Scalar> told_per_given = ones<N, Scalar>();
  bool has_torque_path = false;  // some effect scales what passes from drive to load
  // Of Transmission; and what rotors of motors add to the mass matrix, kg m^2, kg m or kg.
  bool has_rotors = false;
  Matrix<N, N, Scalar> motor_per_joint = no_values<Matrix<N, N, Scalar>>();
  Vector<N, Scalar> motor_offset_rad = no_values<Vector<N, Scalar>>();
  Matrix<N, N, Scalar> rotors = no_values<Matrix<N, N, Scalar>>();
};

namespace detail {

template <int N, typename Scalar>
void take_transmission(const Transmission<N, Scalar>& transmission,
                       RigidBodyModel<N, Scalar>& model) {
  const auto count = static_cast<Eigen::Index>(model.bodies.size());
  if constexpr (N == kRuntimeJoints) {
    model.motor_per_joint.resize(count, count);
    model.motor_offset_rad.resize(count);
    model.rotors.setZero(count, count);
  }
  for (Eigen::Index motor = 0; motor < count; ++motor) {
    const auto row = static_cast<std::size_t>(motor);
    model.motor_offset_rad[motor] = transmission.motor_offset_rad[row];
    for (Eigen::Index joint = 0; joint < count; ++joint) {
      model.motor_per_joint(motor, joint) =
          transmission.motor_per_joint[row * transmission.kMost + static_cast<std::size_t>(joint)];
    }
  }
}

// A rotor turns with its motor, 2 T = inertia (row . dq)^2, with the motor's row of A.
template <int N, typename Scalar>
EIGEN_DONT_INLINE void add_rotor(Eigen::Index motor, Scalar inertia,
                                 RigidBodyModel<N, Scalar>& model) {
  model.has_rotors = true;
  for (Eigen::Index i = 0; i < model.rotors.rows(); ++i) {
    for (Eigen::Index k = 0; k < model.rotors.cols(); ++k) {
      model.rotors(i, k) +=
          inertia * model.motor_per_joint(motor, i) * model.motor_per_joint(motor, k);
    }
  }
}

}  // namespace detail

// Makes the model of a chain that validate() has accepted; of any other the result is undefined
// (no crash, no meaning). Effects with a memory are none of an instant: effect_memory.hpp has them.
template <int N, typename Scalar>
[[nodiscard]] RigidBodyModel<N, Scalar> make_model(const Chain<N, Scalar>& chain) {
  using Vec3 = Vector<3, Scalar>;
  using Mat3 = Matrix<3, 3, Scalar>;
  RigidBodyModel<N, Scalar> model;
  const std::size_t count = chain.joints.size();
  if constexpr (N == kRuntimeJoints) {
    model.bodies.assign(count, {});
    model.told_per_given.setOnes(static_cast<Eigen::Index>(count));
  }
  model.gravity = Vec3(chain.gravity_m_s2[0], chain.gravity_m_s2[1], chain.gravity_m_s2[2]);
  for (std::size_t i = 0; i < count; ++i) {
    const Joint<Scalar>& joint = chain.joints[i];
    auto& body = model.bodies[i];
    body.type = joint.type;
    body.axis = Vec3(joint.axis[0], joint.axis[1], joint.axis[2]);
    body.origin = Vec3(joint.origin_m[0], joint.origin_m[1], joint.origin_m[2]);
    Mat3 rotation;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        rotation(row, column) = joint.rotation[static_cast<std::size_t>(3 * row + column)];
      }
    }
    if (joint.type == JointType::kRevolute) {
      const Mat3 axis_cross = detail::cross_matrix(body.axis);
      const Mat3 axis_cross_squared = axis_cross.lazyProduct(axis_cross);
      body.fixed = rotation + rotation.lazyProduct(axis_cross_squared);
      body.sine = rotation.lazyProduct(axis_cross);
      body.cosine = -rotation.lazyProduct(axis_cross_squared);
    } else {
      body.fixed = rotation;
      body.slide = rotation * body.axis;
    }
    const Vec3 centre(joint.centre_of_mass_m[0], joint.centre_of_mass_m[1],
                      joint.centre_of_mass_m[2]);
    body.link.add_point_mass(joint.mass_kg, centre);
    const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
    Mat3 about_centre;
    about_centre << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    body.link.inertia += about_centre;
  }
  detail::take_transmission(chain.transmission, model);
  for (Effect<Scalar> effect : chain.effects.view()) {
    if (effect.joint >= count || !source_joint_valid(effect, static_cast<int>(count))) continue;
    const Joint<Scalar>& joint = chain.joints[effect.joint];
    auto& body = model.bodies[effect.joint];
    visit_effect(effect.kind, [&]<typename E>() {
      if constexpr (requires { E::prepare(effect.parameters, joint.type); }) {
        E::prepare(effect.parameters, effect.of_motor ? JointType::kRevolute : joint.type);
      }
      if constexpr (requires { E::reflected_inertia(effect.parameters); }) {
        const Scalar inertia = E::reflected_inertia(effect.parameters);
        if (effect.of_motor) {
          detail::add_rotor(static_cast<Eigen::Index>(effect.joint), inertia, model);
        } else {
          body.reflected_inertia += inertia;
        }
      } else if constexpr (requires { E::point_mass(effect.parameters, joint.centre_of_mass_m); }) {
        const auto added = E::point_mass(effect.parameters, joint.centre_of_mass_m);
        body.link.add_point_mass(
            added.mass_kg, Vec3(added.position_m[0], added.position_m[1], added.position_m[2]));
      } else if constexpr (requires { E::told_per_given(effect.parameters); }) {
        model.told_per_given[effect.joint] *= E::told_per_given(effect.parameters);
        model.has_torque_path = true;
      } else if constexpr (requires { E::most_friction_per_load(effect.parameters); }) {
        model.has_torque_path = true;
        static_cast<void>(model.torque_effects.add(effect));
      } else if constexpr (requires(JointInstant<Scalar> at) {
                             E::torque(effect.parameters, at);
                           }) {
        static_cast<void>(model.torque_effects.add(effect));
      }
    });
  }
  return model;
}

}  // namespace offnominal
