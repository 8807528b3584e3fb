#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <offnominal/model/rigid_body_model.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk::studio {

using ArmModel = RigidBodyModel<kRuntimeJoints, double>;

/// Where every link's frame is, in the base frame, at the position `q` of the joints, rad or m: the
/// core's joint transforms one after the other. `q` has one number per joint; one that is not
/// finite gives frames from there on that are not.
std::vector<Eigen::Isometry3d> link_frames(const ArmModel& model,
                                           const Eigen::Ref<const Eigen::VectorXd>& q);

/// What a link looks like as far as a robot file knows it.
struct LinkShape {
  // Where it ends, m, link's frame: at the next joint. The last one ends where an even rod from its
  // joint on, with the link's mass, centre of mass and transverse inertia, would; a revolute one of
  // which the file says no length is given a pointer, so that it is seen to turn.
  Eigen::Vector3d end_m = Eigen::Vector3d::Zero();
  // The frame's first and last place along a prismatic joint, m, in the frame before it; none for
  // a revolute joint.
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> rail_m;
};

struct ArmShape {
  std::vector<LinkShape> links;
  // Sum of all lengths, m: how far the arm can reach at most; 1 where the file says no length.
  double reach_m = 1;
  bool knows_lengths = true;  // the file says one at least
};

/// `lowest` and `highest`: of every joint's position, rad or m, where the rails begin and end.
ArmShape shape_of(const RobotDescription& robot, const Eigen::Ref<const Eigen::VectorXd>& lowest,
                  const Eigen::Ref<const Eigen::VectorXd>& highest);

}  // namespace offnominal::desk::studio
