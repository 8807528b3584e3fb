#include "campaign/kdl_observer.hpp"

#include <array>
#include <kdl/chain.hpp>
#include <kdl/chainexternalwrenchestimator.hpp>
#include <offnominal/model/torque_path.hpp>
#include <stdexcept>

#include "common/error.hpp"
#include "robot/chain_of.hpp"

namespace offnominal::desk::campaign {
namespace {

using Model = RigidBodyModel<kRuntimeJoints, double>;
using Joints = Vector<kRuntimeJoints, double>;

KDL::Vector to_kdl(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// KDL places a joint in the frame before it; its tip frame at q = 0 is this project's joint frame.
// The link is taken from the model, where payloads and masses that effects add are part of it.
KDL::Segment segment_of(const Joint<double>& joint, const Model::Body& body) {
  const auto& r = joint.rotation;
  const KDL::Rotation rotation(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
  const KDL::Vector origin = to_kdl(joint.origin_m);
  const auto type =
      joint.type == JointType::kRevolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
  const KDL::Joint moving(origin, rotation * to_kdl(joint.axis), type, 1, 0,
                          body.reflected_inertia);
  const SpatialInertia<double>& link = body.link;
  const double mass = link.mass;
  const Eigen::Vector3d centre = mass > 0 ? Eigen::Vector3d(link.first_moment / mass)
                                          : Eigen::Vector3d(Eigen::Vector3d::Zero());
  const Eigen::Matrix3d about_centre =
      link.inertia -
      mass * (centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose());
  const KDL::RigidBodyInertia inertia(
      mass, KDL::Vector(centre.x(), centre.y(), centre.z()),
      KDL::RotationalInertia(about_centre(0, 0), about_centre(1, 1), about_centre(2, 2),
                             about_centre(0, 1), about_centre(0, 2), about_centre(1, 2)));
  return KDL::Segment(moving, KDL::Frame(rotation, origin), inertia);
}

KDL::JntArray to_kdl(const Joints& v) {
  KDL::JntArray array(static_cast<unsigned>(v.size()));
  array.data = v;
  return array;
}

KDL::Chain chain_of_model(const RobotDescription& robot, const Model& model) {
  if (model.has_rotors) {
    throw InputError({.file = "robot " + robot.name,
                      .place = "effect",
                      .found = "rotor inertia of a motor",
                      .allowed = "rotor inertias of joints: KDL knows no other",
                      .mend = "leave the detector kdl out, or give the rotor to its joint"});
  }
  KDL::Chain chain;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    chain.addSegment(segment_of(robot.joints[i].joint, model.bodies[i]));
  }
  return chain;
}

}  // namespace

Eigen::MatrixXd kdl_residual(const RobotDescription& robot, double gain_per_s, double filter_share,
                             const Log& log) {
  const Model model = make_model(chain_of<kRuntimeJoints, double>(robot));
  const KDL::Chain chain = chain_of_model(robot, model);
  KDL::ChainExternalWrenchEstimator estimator(chain, to_kdl(robot.gravity_m_s2), 1 / log.period_s,
                                              gain_per_s, filter_share);
  Eigen::MatrixXd residual(log.q.rows(), log.q.cols());
  KDL::JntArray torque(static_cast<unsigned>(log.q.cols()));
  KDL::Wrench wrench;
  for (Eigen::Index row = 0; row < log.q.rows(); ++row) {
    const Joints q = log.q.row(row).transpose();
    const Joints dq = log.dq.row(row).transpose();
    const Joints tau = log.tau.row(row).transpose();
    const Joints load = load_torque(model, joint_effects(model, q, dq, log.t_s[row]), tau);
    const KDL::JntArray position = to_kdl(q);
    const KDL::JntArray velocity = to_kdl(dq);
    int error = 0;
    if (row == 0) {
      // Its first call takes all of M for a change of M over one period: made before it is told
      // where it begins, which forgets all but the M that it compares the next one with.
      error = estimator.JntToExtWrench(position, velocity, to_kdl(load), wrench);
      if (error >= 0) error = estimator.setInitialMomentum(position, velocity);
    }
    if (error >= 0) error = estimator.JntToExtWrench(position, velocity, to_kdl(load), wrench);
    if (error < 0) {
      throw std::runtime_error(log.file + ": KDL: " + estimator.strError(error));
    }
    estimator.getEstimatedJntTorque(torque);
    residual.row(row) = torque.data;
  }
  return residual;
}

}  // namespace offnominal::desk::campaign
