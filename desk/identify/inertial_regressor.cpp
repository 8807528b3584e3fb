#include "identify/inertial_regressor.hpp"

#include <array>
#include <offnominal/model/inverse_dynamics.hpp>
#include <stdexcept>

#include "robot/chain_of.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// A body of which one number is 1 and the others are 0. No body is like this; the recursion does
// not mind.
SpatialInertia<double> unit_body(Index number) {
  SpatialInertia<double> body;
  switch (number) {
    case 0:
      body.mass = 1;
      break;
    case 1:
    case 2:
    case 3:
      body.first_moment[number - 1] = 1;
      break;
    case 4:
    case 5:
    case 6:
      body.inertia(number - 4, number - 4) = 1;
      break;
    default: {
      constexpr std::array<std::array<Index, 2>, 3> kPlaces{{{0, 1}, {0, 2}, {1, 2}}};
      const auto& [row, column] = kPlaces[static_cast<std::size_t>(number - 7)];
      body.inertia(row, column) = 1;
      body.inertia(column, row) = 1;
    }
  }
  return body;
}

}  // namespace

const char* symbol_of_inertial_number(Index number) {
  constexpr std::array<const char*, kInertialNumbers> kSymbols{"m",   "hx",  "hy",  "hz",  "Ixx",
                                                               "Iyy", "Izz", "Ixy", "Ixz", "Iyz"};
  return kSymbols[static_cast<std::size_t>(number)];
}

const char* unit_of_inertial_number(Index number) {
  if (number == 0) return "kg";
  return number < 4 ? "kg m" : "kg m^2";
}

InertialNumbers inertial_numbers_of(const Joint<double>& joint) {
  const Eigen::Vector3d centre(joint.centre_of_mass_m.data());
  SpatialInertia<double> body;
  body.add_point_mass(joint.mass_kg, centre);
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  InertialNumbers numbers;
  numbers << body.mass, body.first_moment, body.inertia(0, 0) + xx, body.inertia(1, 1) + yy,
      body.inertia(2, 2) + zz, body.inertia(0, 1) + xy, body.inertia(0, 2) + xz,
      body.inertia(1, 2) + yz;
  return numbers;
}

std::vector<MatrixXd> inertial_regressor(const RobotDescription& robot, std::size_t link,
                                         const Motion& motion) {
  if (motion.q.cols() != robot.joint_count()) {
    throw std::invalid_argument("the motion has another number of joints than the robot");
  }
  // What is behind the link has no part in it.
  RobotDescription rigid = robot;
  rigid.effects.clear();
  rigid.joints.resize(link + 1);
  using Joints = Vector<kRuntimeJoints, double>;
  auto model = make_model(chain_of<kRuntimeJoints, double>(rigid));
  for (auto& body : model.bodies) body.link = {};
  std::vector<MatrixXd> torques(static_cast<std::size_t>(kInertialNumbers),
                                MatrixXd::Zero(motion.sample_count(), robot.joint_count()));
  const auto joints = static_cast<Index>(link + 1);
  for (Index i = 0; i < motion.sample_count(); ++i) {
    const Joints q = motion.q.row(i).head(joints);
    const Joints dq = motion.dq.row(i).head(joints);
    const Joints ddq = motion.ddq.row(i).head(joints);
    const auto transforms = joint_transforms(model, q);
    for (Index number = 0; number < kInertialNumbers; ++number) {
      model.bodies[link].link = unit_body(number);
      torques[static_cast<std::size_t>(number)].row(i).head(joints) =
          rigid_body_torque(model, transforms, dq, ddq);
    }
  }
  return torques;
}

}  // namespace offnominal::desk
