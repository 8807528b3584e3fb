#include "compare/body_torque.hpp"

#include <algorithm>
#include <offnominal/model/inverse_dynamics.hpp>
#include <tuple>

#include "robot/chain_of.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

bool is_point_mass(const RobotEffect& effect) {
  return info_of(effect.kind)->action == EffectAction::kPointMass;
}

bool are_same(const RobotEffect& a, const RobotEffect& b) {
  return a.kind == b.kind && a.joint == b.joint && a.of_motor == b.of_motor &&
         a.parameters == b.parameters;
}

MatrixXd torque_of_links(const RobotDescription& links, const Motion& motion) {
  const auto model = make_model(chain_of<kRuntimeJoints, double>(links));
  using Joints = Vector<kRuntimeJoints, double>;
  MatrixXd torque(motion.sample_count(), motion.q.cols());
  for_stretches(motion, [&](Index first, Index count) {
    for (Index i = first; i < first + count; ++i) {
      const Joints q = motion.q.row(i);
      const Joints dq = motion.dq.row(i);
      const Joints ddq = motion.ddq.row(i);
      torque.row(i) = rigid_body_torque(model, joint_transforms(model, q), dq, ddq);
    }
  });
  return torque;
}

}  // namespace

bool have_same_bodies(const RobotDescription& a, const RobotDescription& b) {
  const auto of = [](const RobotJoint& one) {
    const Joint<double>& joint = one.joint;
    return std::tie(joint.type, joint.axis, joint.origin_m, joint.rotation, joint.mass_kg,
                    joint.centre_of_mass_m, joint.inertia_kg_m2);
  };
  return a.gravity_m_s2 == b.gravity_m_s2 &&
         std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [&](const RobotJoint& x, const RobotJoint& y) { return of(x) == of(y); });
}

MatrixXd BodyTorque::of(const RobotDescription& robot, const Motion& motion) {
  RobotDescription links = robot;
  std::erase_if(links.effects, [](const RobotEffect& effect) { return !is_point_mass(effect); });
  const bool is_known = torque_.rows() == motion.sample_count() &&
                        torque_.cols() == motion.q.cols() && have_same_bodies(links, links_) &&
                        std::equal(links.effects.begin(), links.effects.end(),
                                   links_.effects.begin(), links_.effects.end(), are_same);
  if (!is_known) {
    torque_ = torque_of_links(links, motion);
    links_ = std::move(links);
  }
  // As core adds them: each joint's own first, then what motors share.
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  MatrixXd torque = torque_;
  for (Index joint = 0; joint < torque.cols(); ++joint) {
    const double inertia = model.bodies[static_cast<std::size_t>(joint)].reflected_inertia;
    if (inertia != 0) torque.col(joint) += inertia * motion.ddq.col(joint);
  }
  for (Index i = 0; model.has_rotors && i < torque.rows(); ++i) {
    const Vector<kRuntimeJoints, double> ddq = motion.ddq.row(i);
    torque.row(i) += model.rotors.lazyProduct(ddq);
  }
  return torque;
}

}  // namespace offnominal::desk
