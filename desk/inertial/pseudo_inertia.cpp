#include "inertial/pseudo_inertia.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::Matrix4d;

namespace {

// Where the coordinates stand in V, from the fifth on: s12 s13 s23 t1 t2 t3.
constexpr std::array<std::array<Index, 2>, 6> kPlaces{
    {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};

// V without its factor e^a.
Matrix4d shape_at(const LogCholesky& point) {
  Matrix4d shape = Matrix4d::Identity();
  for (Index i = 0; i < 3; ++i) shape(i, i) = std::exp(point[1 + i]);
  Index at = 4;
  for (const auto& place : kPlaces) shape(place[0], place[1]) = point[at++];
  return shape;
}

}  // namespace

PseudoInertia pseudo_inertia_of(const InertialNumbers& numbers) {
  const double half_trace = (numbers[4] + numbers[5] + numbers[6]) / 2;
  PseudoInertia inertia;
  inertia << half_trace - numbers[4], -numbers[7], -numbers[8], numbers[1],  //
      -numbers[7], half_trace - numbers[5], -numbers[9], numbers[2],         //
      -numbers[8], -numbers[9], half_trace - numbers[6], numbers[3],         //
      numbers[1], numbers[2], numbers[3], numbers[0];
  return inertia;
}

InertialNumbers inertial_numbers_of(const PseudoInertia& inertia) {
  InertialNumbers numbers;
  numbers << inertia(3, 3), inertia(0, 3), inertia(1, 3), inertia(2, 3),
      inertia(1, 1) + inertia(2, 2), inertia(0, 0) + inertia(2, 2), inertia(0, 0) + inertia(1, 1),
      -inertia(0, 1), -inertia(0, 2), -inertia(1, 2);
  return numbers;
}

Matrix4d upper_factor_of(const PseudoInertia& inertia) {
  // The lower factor of the matrix read backwards is the upper one, read backwards.
  const Matrix4d backwards = inertia.reverse();
  const Matrix4d lower = backwards.llt().matrixL();
  return lower.reverse();
}

InertialNumbers inertial_numbers_at(const Matrix4d& about, const LogCholesky& point) {
  const Matrix4d upper = std::exp(point[0]) * (about * shape_at(point));
  return inertial_numbers_of(PseudoInertia(upper * upper.transpose()));
}

Eigen::Matrix<double, kInertialNumbers, kInertialNumbers> inertial_slopes_at(
    const Matrix4d& about, const LogCholesky& point) {
  const Matrix4d shape = shape_at(point);
  const double size = std::exp(2 * point[0]);
  const auto slope = [&](const Matrix4d& change) {
    const Matrix4d half = size * (change * shape.transpose());
    return inertial_numbers_of(
        PseudoInertia(about * (half + half.transpose()) * about.transpose()));
  };
  Eigen::Matrix<double, kInertialNumbers, kInertialNumbers> slopes;
  slopes.col(0) = slope(shape);
  for (Index i = 0; i < 3; ++i) {
    Matrix4d change = Matrix4d::Zero();
    change(i, i) = shape(i, i);
    slopes.col(1 + i) = slope(change);
  }
  Index at = 4;
  for (const auto& place : kPlaces) {
    Matrix4d change = Matrix4d::Zero();
    change(place[0], place[1]) = 1;
    slopes.col(at++) = slope(change);
  }
  return slopes;
}

void put_inertia(const InertialNumbers& numbers, Joint<double>& joint) {
  const double mass = numbers[0];
  const Eigen::Vector3d centre = numbers.segment<3>(1) / mass;
  joint.mass_kg = mass;
  joint.centre_of_mass_m = {centre.x(), centre.y(), centre.z()};
  const double squared = centre.squaredNorm();
  joint.inertia_kg_m2 = {numbers[4] - mass * (squared - centre.x() * centre.x()),
                         numbers[5] - mass * (squared - centre.y() * centre.y()),
                         numbers[6] - mass * (squared - centre.z() * centre.z()),
                         numbers[7] + mass * centre.x() * centre.y(),
                         numbers[8] + mass * centre.x() * centre.z(),
                         numbers[9] + mass * centre.y() * centre.z()};
}

}  // namespace offnominal::desk
