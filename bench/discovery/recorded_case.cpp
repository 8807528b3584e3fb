#include "recorded_case.hpp"

#include <cmath>
#include <numbers>

namespace offnominal::bench {

using sim::hidden::Nominal;
using sim::hidden::NominalJoint;
using sim::hidden::NominalLink;

desk::Log log_of(const sim::hidden::Recording& recording) {
  desk::Log log;
  log.file = "simulated";
  log.period_s = recording.t_s[1] - recording.t_s[0];
  log.t_s = recording.t_s;
  log.q = recording.q;
  log.dq = Eigen::MatrixXd::Zero(recording.q.rows(), recording.q.cols());
  log.tau = recording.tau;
  log.dq_derived.assign(static_cast<std::size_t>(recording.q.cols()), true);
  return log;
}

namespace {

void add_known_effects(const NominalJoint& known, std::uint8_t joint,
                       desk::RobotDescription& robot) {
  const auto add = [&](EffectKind kind, std::array<double, kMaxEffectParameters> parameters) {
    if (parameters[0] == 0) return;  // this is what is hidden
    desk::RobotEffect effect;
    effect.kind = kind;
    effect.joint = joint;
    effect.parameters = parameters;
    effect.fitted = true;
    robot.effects.push_back(effect);
  };
  constexpr double kSmoothingRadS = 0.01;
  add(EffectKind::kViscousFriction, {known.viscous_nm_s_rad});
  add(EffectKind::kCoulombFriction, {known.coulomb_nm, kSmoothingRadS});
  add(EffectKind::kRotorInertia, {known.rotor_inertia_kg_m2});
}

desk::RobotJoint joint_of(const NominalLink& link, const NominalJoint& known, int encoder_bits) {
  desk::RobotJoint joint;
  joint.joint.mass_kg = link.mass_kg;
  joint.joint.centre_of_mass_m = {link.centre_of_mass_m, 0, 0};
  // The arm is planar: only the last axis matters, the others keep the tensor physical.
  const double inertia = link.inertia_kg_m2;
  joint.joint.inertia_kg_m2 = {inertia / 2, inertia / 2, inertia, 0, 0, 0};
  joint.joint.min_position = known.position_min_rad;
  joint.joint.max_position = known.position_max_rad;
  joint.joint.max_velocity = known.velocity_limit_rad_s;
  joint.joint.max_torque = known.torque_limit_nm;
  joint.encoder.counts_per_unit = std::exp2(encoder_bits) / (2 * std::numbers::pi);
  return joint;
}

}  // namespace

desk::RobotDescription robot_of(const Nominal& nominal) {
  desk::RobotDescription robot;
  robot.gravity_m_s2 = {0, -nominal.gravity_m_s2, 0};
  for (std::size_t i = 0; i < nominal.links.size(); ++i) {
    robot.joints.push_back(joint_of(nominal.links[i], nominal.joints[i], nominal.encoder_bits));
    robot.joints[i].name = i == 0 ? "shoulder" : "elbow";
    if (i > 0) robot.joints[i].joint.origin_m = {nominal.links[i - 1].length_m, 0, 0};
    add_known_effects(nominal.joints[i], static_cast<std::uint8_t>(i), robot);
  }
  return robot;
}

}  // namespace offnominal::bench
