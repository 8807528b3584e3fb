#include "inertial/link_prior.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace offnominal::desk {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// From the joint of a link to the next one, in the link's frame; 0 behind the last.
Vector3d reach_of(const RobotDescription& robot, std::size_t link) {
  if (link + 1 >= robot.joints.size()) return Vector3d::Zero();
  return Vector3d(robot.joints[link + 1].joint.origin_m.data());
}

// Mean length of the links that have one, m; of an arm without any, 0.3.
double mean_reach(const RobotDescription& robot) {
  double sum = 0;
  int count = 0;
  for (std::size_t link = 0; link < robot.joints.size(); ++link) {
    const double length = reach_of(robot, link).norm();
    sum += length;
    count += length > 0;
  }
  constexpr double kUnknown = 0.3;
  return count > 0 ? sum / count : kUnknown;
}

}  // namespace

PseudoInertia believed_inertia(const RobotDescription& robot, std::size_t link) {
  constexpr double kPoint = 0.2;  // radius of gyration of a point mass, of the arm's mean link
  constexpr double kThin = 0.05;  // of a rod or a plate, of its extent
  const Joint<double>& joint = robot.joints[link].joint;
  const double mass = joint.mass_kg;
  const Vector3d centre(joint.centre_of_mass_m.data());
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  Matrix3d spread;  // second moments about the centre, per mass
  const double half_trace = (xx + yy + zz) / 2;
  spread << half_trace - xx, -xy, -xz, -xy, half_trace - yy, -yz, -xz, -yz, half_trace - zz;
  spread /= mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(spread);
  const double largest = axes.eigenvalues().maxCoeff();
  double least = kThin * kThin * largest;
  if (!(largest > 0)) {
    const double radius = kPoint * mean_reach(robot);
    least = radius * radius;
  }
  const Vector3d thick = axes.eigenvalues().cwiseMax(least);
  spread = axes.eigenvectors() * thick.asDiagonal() * axes.eigenvectors().transpose();
  PseudoInertia inertia;
  inertia.topLeftCorner<3, 3>() = mass * (spread + centre * centre.transpose());
  inertia.topRightCorner<3, 1>() = mass * centre;
  inertia.bottomLeftCorner<1, 3>() = mass * centre.transpose();
  inertia(3, 3) = mass;
  return inertia;
}

std::vector<Joint<double>> joints_of_geometry(const RobotDescription& robot) {
  constexpr double kThickness = 0.25;
  constexpr double kLast = 0.5;  // that of the last link: its mass may be anywhere about its joint
  const double mean = mean_reach(robot);
  std::vector<Joint<double>> joints;
  for (std::size_t link = 0; link < robot.joints.size(); ++link) {
    Joint<double> joint = robot.joints[link].joint;
    const Vector3d reach = reach_of(robot, link);
    const double mass = std::max(reach.norm(), mean / 2);  // 1 kg/m
    const Vector3d centre = reach / 2;
    const double radius = (link + 1 < robot.joints.size() ? kThickness : kLast) * mean;
    const Matrix3d spread = reach * reach.transpose() / 12 + radius * radius * Matrix3d::Identity();
    PseudoInertia inertia;
    inertia.topLeftCorner<3, 3>() = mass * (spread + centre * centre.transpose());
    inertia.topRightCorner<3, 1>() = mass * centre;
    inertia.bottomLeftCorner<1, 3>() = mass * centre.transpose();
    inertia(3, 3) = mass;
    put_inertia(inertial_numbers_of(inertia), joint);
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace offnominal::desk
