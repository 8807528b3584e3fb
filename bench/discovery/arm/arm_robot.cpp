#include "arm_robot.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>
#include <vector>

namespace offnominal::bench {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using sim::hidden::Draws;

namespace {

// A joint of an arm of reach 1: where it sits in the link before it, its axis, the link's share of
// the mass.
struct JointPlan {
  Vector3d origin;
  Vector3d axis;
  double mass_share;
};
struct ArmPlan {
  std::string name;
  std::vector<JointPlan> joints;
  Vector3d flange;
};

const Vector3d kX = Vector3d::UnitX();
const Vector3d kY = Vector3d::UnitY();
const Vector3d kZ = Vector3d::UnitZ();

ArmPlan plan_of(int which) {
  switch (which) {
    case 0:
      return {"spherical-wrist",
              {{{0, 0, 0.25}, kZ, 0.27},
               {{0.12, 0, 0.1}, kY, 0.26},
               {{0, 0, 0.46}, kY, 0.22},
               {{0.1, 0, 0.06}, kX, 0.13},
               {{0.36, 0, 0}, kY, 0.08},
               {{0.06, 0, 0}, kX, 0.04}},
              {0.04, 0, 0}};
    case 1:
      return {"parallel-axes",
              {{{0, 0, 0.15}, kZ, 0.2},
               {{0, 0.13, 0}, kY, 0.34},
               {{0.43, -0.11, 0}, kY, 0.22},
               {{0.4, 0, 0}, kY, 0.1},
               {{0, 0.1, 0}, kZ, 0.09},
               {{0, 0, -0.1}, kY, 0.05}},
              {0, 0.06, 0}};
    default:
      return {"seven-joints",
              {{{0, 0, 0.34}, kZ, 0.2},
               {{0, 0, 0}, kY, 0.19},
               {{0, 0, 0.33}, kZ, 0.17},
               {{0.08, 0, 0}, -kY, 0.16},
               {{-0.08, 0, 0.38}, kZ, 0.14},
               {{0, 0, 0}, -kY, 0.09},
               {{0.09, 0, 0}, -kZ, 0.05}},
              {0, 0, -0.1}};
  }
}

Vector3d drawn_vector(Draws& draws, double size) {
  const double x = draws.uniform(-size, size);
  const double y = draws.uniform(-size, size);
  return {x, y, draws.uniform(-size, size)};
}

Matrix3d turn_by(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
}

void put_tensor(const Matrix3d& tensor, Joint<double>& joint) {
  joint.inertia_kg_m2 = {tensor(0, 0), tensor(1, 1), tensor(2, 2),
                         tensor(0, 1), tensor(0, 2), tensor(1, 2)};
}

// A box from the joint to the next one, a little askew.
void put_body(const Vector3d& to_next, double mass, double reach, Draws& draws,
              Joint<double>& joint) {
  const double thickness = reach * draws.uniform(0.05, 0.09);
  const double along = draws.uniform(0.35, 0.65);
  const Vector3d centre = along * to_next + drawn_vector(draws, 0.03 * reach);
  const Vector3d half = to_next.cwiseAbs() / 2 + Vector3d::Constant(thickness);
  const Vector3d moments =
      mass / 3 *
      Vector3d(half.y() * half.y() + half.z() * half.z(), half.x() * half.x() + half.z() * half.z(),
               half.x() * half.x() + half.y() * half.y());
  const Matrix3d turn = turn_by(drawn_vector(draws, 0.2));
  joint.mass_kg = mass;
  joint.centre_of_mass_m = {centre.x(), centre.y(), centre.z()};
  put_tensor(turn * moments.asDiagonal() * turn.transpose(), joint);
}

}  // namespace

desk::RobotDescription draw_rigid_arm(Draws& draws) {
  const ArmPlan plan = plan_of(draws.below(3));
  const double reach = draws.log_uniform(0.6, 1.8);
  const double total = 28 * std::pow(reach, 2.3) * draws.uniform(0.7, 1.4);
  desk::RobotDescription robot;
  robot.name = plan.name;
  for (std::size_t i = 0; i < plan.joints.size(); ++i) {
    const JointPlan& own = plan.joints[i];
    desk::RobotJoint joint;
    joint.name = "axis" + std::to_string(i + 1);
    const Vector3d origin = reach * own.origin * draws.uniform(0.9, 1.1);
    joint.joint.origin_m = {origin.x(), origin.y(), origin.z()};
    joint.joint.axis = {own.axis.x(), own.axis.y(), own.axis.z()};
    const Vector3d next = i + 1 < plan.joints.size() ? plan.joints[i + 1].origin : plan.flange;
    put_body(reach * next, total * own.mass_share * draws.uniform(0.8, 1.2), reach, draws,
             joint.joint);
    robot.joints.push_back(joint);
  }
  return robot;
}

double total_mass_kg(const desk::RobotDescription& robot) {
  return std::accumulate(robot.joints.begin(), robot.joints.end(), 0.0,
                         [](double sum, const auto& one) { return sum + one.joint.mass_kg; });
}

void add_effect(desk::RobotDescription& robot, EffectKind kind, Eigen::Index joint,
                std::array<double, kMaxEffectParameters> parameters) {
  desk::RobotEffect effect;
  effect.kind = kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  effect.parameters = parameters;
  // As in the files that `offnominal add` writes.
  effect.fitted = true;
  robot.effects.push_back(effect);
}

}  // namespace offnominal::bench
