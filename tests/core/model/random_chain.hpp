#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <random>

namespace offnominal::test {

inline double uniform(std::mt19937_64& generator, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator);
}

inline Eigen::Vector3d random_vector3(std::mt19937_64& generator, double size) {
  return {uniform(generator, -size, size), uniform(generator, -size, size),
          uniform(generator, -size, size)};
}

inline Eigen::Vector3d random_direction(std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Eigen::Vector3d direction(normal(generator), normal(generator), normal(generator));
  return direction.normalized();
}

inline Eigen::Matrix3d random_rotation(std::mt19937_64& generator) {
  const double angle = uniform(generator, -std::numbers::pi, std::numbers::pi);
  return Eigen::AngleAxisd(angle, random_direction(generator)).toRotationMatrix();
}

// Inertia tensor about the centre of mass of five point masses: one that a body can have.
inline Eigen::Matrix3d random_inertia(std::mt19937_64& generator) {
  std::array<Eigen::Vector3d, 5> points;
  std::array<double, 5> masses{};
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = random_vector3(generator, 0.3);
    masses[i] = uniform(generator, 0.1, 0.6);
    centre += masses[i] * points[i];
    mass += masses[i];
  }
  centre /= mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d from_centre = points[i] - centre;
    inertia += masses[i] * (from_centre.squaredNorm() * Eigen::Matrix3d::Identity() -
                            from_centre * from_centre.transpose());
  }
  return inertia;
}

template <typename Scalar>
std::array<Scalar, 3> to_array(const Eigen::Vector3d& v) {
  return {static_cast<Scalar>(v.x()), static_cast<Scalar>(v.y()), static_cast<Scalar>(v.z())};
}

template <typename Scalar>
std::array<Scalar, 9> rows_of(const Eigen::Matrix3d& m) {
  std::array<Scalar, 9> rows{};
  for (Eigen::Index i = 0; i < 9; ++i) {
    rows[static_cast<std::size_t>(i)] = static_cast<Scalar>(m(i / 3, i % 3));
  }
  return rows;
}

template <typename Scalar>
Joint<Scalar> random_joint(std::mt19937_64& generator) {
  Joint<Scalar> joint;
  joint.type = uniform(generator, 0, 1) < 0.6 ? JointType::kRevolute : JointType::kPrismatic;
  joint.axis = to_array<Scalar>(random_direction(generator));
  joint.origin_m = to_array<Scalar>(random_vector3(generator, 0.5));
  joint.rotation = rows_of<Scalar>(random_rotation(generator));
  joint.mass_kg = static_cast<Scalar>(uniform(generator, 0.5, 5.0));
  joint.centre_of_mass_m = to_array<Scalar>(random_vector3(generator, 0.3));
  const Eigen::Matrix3d inertia = random_inertia(generator);
  joint.inertia_kg_m2 = {static_cast<Scalar>(inertia(0, 0)), static_cast<Scalar>(inertia(1, 1)),
                         static_cast<Scalar>(inertia(2, 2)), static_cast<Scalar>(inertia(0, 1)),
                         static_cast<Scalar>(inertia(0, 2)), static_cast<Scalar>(inertia(1, 2))};
  return joint;
}

// Revolute and prismatic joints about any axis, every dimension random, no effects.
template <int N, typename Scalar>
Chain<N, Scalar> random_chain(std::mt19937_64& generator) {
  Chain<N, Scalar> chain;
  for (Joint<Scalar>& joint : chain.joints) joint = random_joint<Scalar>(generator);
  chain.gravity_m_s2 = to_array<Scalar>(9.81 * random_direction(generator));
  return chain;
}

template <int N, typename Scalar>
Vector<N, Scalar> random_vector(std::mt19937_64& generator, double size) {
  Vector<N, Scalar> v;
  for (Eigen::Index i = 0; i < N; ++i) v[i] = static_cast<Scalar>(uniform(generator, -size, size));
  return v;
}

// Largest deviation, relative where the numbers are above 1.
template <typename Actual, typename Expected>
double deviation(const Eigen::MatrixBase<Actual>& actual,
                 const Eigen::MatrixBase<Expected>& expected) {
  const auto& a = actual.template cast<double>();
  const auto& b = expected.template cast<double>();
  const double scale = std::max(1.0, b.cwiseAbs().maxCoeff());
  const double difference = (a - b).cwiseAbs().maxCoeff();
  // A NaN must not compare as "small".
  return difference >= 0 ? difference / scale : std::numeric_limits<double>::infinity();
}

}  // namespace offnominal::test
