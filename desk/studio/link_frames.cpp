#include "studio/link_frames.hpp"

#include <algorithm>
#include <cmath>
#include <offnominal/model/joint_transforms.hpp>

namespace offnominal::desk::studio {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kPointer = 0.25;  // of the reach

Vector3d vector_of(const std::array<double, 3>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

Matrix3d rotation_of(const Joint<double>& joint) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(joint.rotation.data());
}

// An even rod has m L^2 / 12 across about its middle.
Vector3d end_of_rod(const Joint<double>& joint) {
  Vector3d centre = vector_of(joint.centre_of_mass_m);
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  Matrix3d inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const bool turns = joint.type == JointType::kRevolute;
  if (centre.norm() == 0 && !turns) return centre;
  const Vector3d along =
      centre.norm() > 0 ? centre.normalized() : vector_of(joint.axis).unitOrthogonal();
  const double across = (inertia.trace() - along.dot(inertia * along)) / 2;
  return centre + std::sqrt(3 * std::max(across, 0.0) / joint.mass_kg) * along;
}

}  // namespace

std::vector<Isometry3d> link_frames(const ArmModel& model,
                                    const Eigen::Ref<const Eigen::VectorXd>& q) {
  const Vector<kRuntimeJoints, double> position = q;
  const auto at = joint_transforms(model, position);
  std::vector<Isometry3d> frames;
  Isometry3d frame = Isometry3d::Identity();
  for (std::size_t joint = 0; joint < model.bodies.size(); ++joint) {
    Isometry3d step = Isometry3d::Identity();
    step.linear() = at.rotation[joint];
    step.translation() = at.origin[joint];
    frame = frame * step;
    frames.push_back(frame);
  }
  return frames;
}

ArmShape shape_of(const RobotDescription& robot, const Eigen::Ref<const Eigen::VectorXd>& lowest,
                  const Eigen::Ref<const Eigen::VectorXd>& highest) {
  ArmShape shape;
  double reach = 0;
  const std::size_t count = robot.joints.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Joint<double>& joint = robot.joints[i].joint;
    const Vector3d origin = vector_of(joint.origin_m);
    LinkShape link;
    link.end_m = i + 1 < count ? vector_of(robot.joints[i + 1].joint.origin_m) : end_of_rod(joint);
    if (i == 0) reach += origin.norm();
    reach += link.end_m.norm();
    if (joint.type == JointType::kPrismatic) {
      const auto at = static_cast<Eigen::Index>(i);
      const Vector3d slide = rotation_of(joint) * vector_of(joint.axis);
      link.rail_m = {origin + lowest[at] * slide, origin + highest[at] * slide};
      reach += std::max(std::abs(lowest[at]), std::abs(highest[at]));
    }
    shape.links.push_back(std::move(link));
  }
  shape.knows_lengths = reach > 0;
  if (shape.knows_lengths) shape.reach_m = reach;
  const Joint<double>& last = robot.joints.back().joint;
  if (last.type == JointType::kRevolute && shape.links.back().end_m.norm() == 0) {
    shape.links.back().end_m = kPointer * shape.reach_m * vector_of(last.axis).unitOrthogonal();
  }
  return shape;
}

}  // namespace offnominal::desk::studio
