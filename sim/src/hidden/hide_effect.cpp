#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Parameters = std::vector<TrueParameter>;

// Periods per turn of the joint: pole pairs, slots, teeth, and gear ratios times them.
constexpr std::array<int, 24> kCoggingOrders = {6,  7,  8,  9,  10, 11, 12, 14, 15, 16, 18, 20,
                                                21, 22, 24, 28, 30, 32, 36, 40, 42, 48, 60, 72};

RobotJoint& joint_of(const HidingPlace& place) {
  return place.robot.joints[static_cast<std::size_t>(place.joint)];
}

NominalJoint& known_of(const HidingPlace& place) {
  return place.nominal.joints[static_cast<std::size_t>(place.joint)];
}

double rms_of(const HidingPlace& place) { return place.survey.rms_nm[place.joint]; }

// Coefficient of a torque that is known along the survey, its share drawn.
double sized(const HidingPlace& place, double low, double high, const VectorXd& unit_torque) {
  return place.size *
         place.survey.scale_to(place.draws.uniform(low, high), place.joint, unit_torque);
}

Parameters hide_coulomb(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  friction.coulomb_nm = place.size * place.draws.uniform(0.05, 0.14) * rms_of(place);
  known_of(place).coulomb_nm = 0.0;
  return {{"level", friction.coulomb_nm, "N m"}};
}

Parameters hide_viscous(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  friction.viscous_nm_s_rad = sized(place, 0.04, 0.12, place.survey.dq.col(place.joint));
  known_of(place).viscous_nm_s_rad = 0.0;
  return {{"coefficient", friction.viscous_nm_s_rad, "N m s/rad"}};
}

Parameters hide_quadratic(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  const VectorXd squared = place.survey.dq.col(place.joint).array().square();
  friction.quadratic_nm_s2_rad2 = sized(place, 0.04, 0.12, squared);
  return {{"coefficient", friction.quadratic_nm_s2_rad2, "N m s^2/rad^2"}};
}

Parameters hide_stribeck(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  const double v = place.draws.log_uniform(0.1, 0.4);
  const VectorXd fall = (-(place.survey.dq.col(place.joint).array() / v).square()).exp();
  friction.stribeck_velocity_rad_s = v;
  friction.stribeck_nm = sized(place, 0.03, 0.07, fall);
  return {{"level", friction.stribeck_nm, "N m"}, {"stribeck_velocity", v, "rad/s"}};
}

Parameters hide_asymmetry(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  const double side = place.draws.sign();
  const double level = side * place.draws.uniform(0.3, 0.7) * place.size;
  const double slope = side * place.draws.uniform(0.3, 0.7) * place.size;
  friction.coulomb_asymmetry_nm = level * friction.coulomb_nm;
  friction.viscous_asymmetry_nm_s_rad = slope * friction.viscous_nm_s_rad;
  return {{"level", friction.coulomb_asymmetry_nm, "N m"},
          {"coefficient", friction.viscous_asymmetry_nm_s_rad, "N m s/rad"}};
}

Parameters hide_load_friction(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  friction.per_load = place.size * place.draws.uniform(0.04, 0.12);
  return {{"coefficient", friction.per_load, ""}};
}

Parameters hide_hysteresis(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  friction.soft_level_nm = place.size * place.draws.uniform(0.06, 0.15) * rms_of(place);
  friction.soft_width_rad = place.draws.log_uniform(0.05, 0.2);
  return {{"level", friction.soft_level_nm, "N m"}, {"width", friction.soft_width_rad, "rad"}};
}

Parameters hide_offset(const HidingPlace& place) {
  JointLoads& loads = joint_of(place).loads;
  const double side = place.draws.sign();
  loads.offset_nm = side * place.size * place.draws.uniform(0.03, 0.1) * rms_of(place);
  return {{"level", loads.offset_nm, "N m"}};
}

Parameters hide_scale(const HidingPlace& place) {
  const double side = place.draws.sign();
  const double share = side * place.size * place.draws.uniform(0.06, 0.2);
  joint_of(place).drive.scale = 1.0 + share;
  return {{"share", share, ""}};
}

Parameters hide_rotor(const HidingPlace& place) {
  const double inertia = sized(place, 0.04, 0.12, place.survey.ddq.col(place.joint));
  joint_of(place).transmission.rotor_inertia_kg_m2 = inertia;
  known_of(place).rotor_inertia_kg_m2 = 0.0;
  return {{"inertia", inertia, "kg m^2"}};
}

Parameters hide_link_mass(const HidingPlace& place) {
  RigidLink& link = place.robot.links[static_cast<std::size_t>(place.joint)];
  const double mass = place.size * place.draws.uniform(0.12, 0.4) * link.mass_kg;
  link.mass_kg += mass;
  return {{"mass", mass, "kg"}};
}

Parameters hide_payload(const HidingPlace& place) {
  const Survey& s = place.survey;
  const std::array<RigidLink, 2>& links = place.robot.links;
  std::array<RigidLink, 2> massless = links;
  for (RigidLink& link : massless) link.mass_kg = link.inertia_kg_m2 = 0.0;
  const PlanarArm unit_tip(massless, place.robot.gravity_m_s2, 1.0);
  VectorXd per_kg(s.tau.rows());
  for (Index k = 0; k < per_kg.size(); ++k) {
    per_kg[k] = unit_tip.torque(s.q.row(k), s.dq.row(k), s.ddq.row(k))[1];
  }
  const double mass = sized(place, 0.08, 0.18, per_kg);
  place.robot.tip_mass_kg = mass;
  return {{"mass", mass, "kg"}, {"x", links[1].length_m, "m"}};
}

Parameters hide_cogging(const HidingPlace& place) {
  JointLoads& loads = joint_of(place).loads;
  const int order =
      kCoggingOrders[static_cast<std::size_t>(place.draws.below(kCoggingOrders.size()))];
  loads.cogging_order = order;
  loads.cogging_phase_rad = place.draws.uniform(0.0, 2.0 * std::numbers::pi);
  const VectorXd wave =
      (loads.cogging_order * place.survey.q.col(place.joint).array() + loads.cogging_phase_rad)
          .sin();
  loads.cogging_nm = sized(place, 0.03, 0.09, wave);
  return {{"sine", loads.cogging_nm * std::cos(loads.cogging_phase_rad), "N m"},
          {"cosine", loads.cogging_nm * std::sin(loads.cogging_phase_rad), "N m"},
          {"order", loads.cogging_order, "1/turn"}};
}

Parameters hide_spring(const HidingPlace& place) {
  JointLoads& loads = joint_of(place).loads;
  const auto q = place.survey.q.col(place.joint);
  loads.spring_rest_rad = q.mean() + place.draws.uniform(-0.5, 0.5);
  loads.spring_nm_rad = sized(place, 0.04, 0.12, q.array() - loads.spring_rest_rad);
  return {{"stiffness", loads.spring_nm_rad, "N m/rad"},
          {"rest_position", loads.spring_rest_rad, "rad"}};
}

// Torque at the joint, to first order, when its link hangs back by `back_rad` along the survey.
VectorXd torque_of_deflection(const HidingPlace& place, const VectorXd& back_rad) {
  const Survey& s = place.survey;
  const PlanarArm arm = place.robot.arm();
  VectorXd change = VectorXd::Zero(s.tau.rows());
  for (Index k = 1; k + 1 < s.tau.rows(); ++k) {
    Eigen::Vector2d q = s.q.row(k), dq = s.dq.row(k), ddq = s.ddq.row(k);
    const double stiff = arm.torque(q, dq, ddq)[place.joint];
    q[place.joint] -= back_rad[k];
    dq[place.joint] -= 0.5 * (back_rad[k + 1] - back_rad[k - 1]) * kSurveyRateHz;
    ddq[place.joint] -=
        (back_rad[k + 1] - 2.0 * back_rad[k] + back_rad[k - 1]) * kSurveyRateHz * kSurveyRateHz;
    change[k] = arm.torque(q, dq, ddq)[place.joint] - stiff;
  }
  return change;
}

double folded_inertia(const HidingPlace& place) {
  return place.robot.arm()
      .terms({0.0, 0.5 * std::numbers::pi}, {0.0, 0.0})
      .mass(place.joint, place.joint);
}

Parameters hide_elasticity(const HidingPlace& place) {
  JointTransmission& t = joint_of(place).transmission;
  constexpr double kProbeNmRad = 1e4;  // stiff enough for the first order to hold
  const VectorXd probe = place.survey.tau.col(place.joint) / kProbeNmRad;
  t.stiffness_nm_rad = kProbeNmRad / sized(place, 0.02, 0.06, torque_of_deflection(place, probe));
  const double damping_ratio = place.draws.uniform(0.04, 0.1);
  t.damping_nm_s_rad = 2.0 * damping_ratio * std::sqrt(t.stiffness_nm_rad * folded_inertia(place));
  return {{"stiffness", t.stiffness_nm_rad, "N m/rad"},
          {"damping", t.damping_nm_s_rad, "N m s/rad"}};
}

Parameters hide_backlash(const HidingPlace& place) {
  JointTransmission& t = joint_of(place).transmission;
  t.gap_rad = place.size * place.draws.uniform(0.004, 0.025);
  if (t.rigid()) {
    const double flank_rad_s = 2.0 * std::numbers::pi * 30.0;
    const double inertia = folded_inertia(place);
    t.stiffness_nm_rad = inertia * flank_rad_s * flank_rad_s;
    t.damping_nm_s_rad = 2.0 * 0.6 * inertia * flank_rad_s;
  }
  return {{"gap", t.gap_rad, "rad"}};
}

Parameters hide_delay(const HidingPlace& place) {
  JointDrive& drive = joint_of(place).drive;
  // Whole tenths of a millisecond are whole substeps of the simulation: the delay is exact.
  drive.delay_s = 1e-4 * std::round(1e4 * place.size * place.draws.uniform(2e-3, 6e-3));
  return {{"delay", drive.delay_s, "s"}};
}

Parameters hide_periodic(const HidingPlace& place) {
  JointLoads& loads = joint_of(place).loads;
  loads.periodic_rad_s = 2.0 * std::numbers::pi * place.draws.log_uniform(1.0, 15.0);
  loads.periodic_phase_rad = place.draws.uniform(0.0, 2.0 * std::numbers::pi);
  loads.periodic_nm =
      place.size * std::numbers::sqrt2 * place.draws.uniform(0.03, 0.09) * rms_of(place);
  return {{"sine", loads.periodic_nm * std::cos(loads.periodic_phase_rad), "N m"},
          {"cosine", loads.periodic_nm * std::sin(loads.periodic_phase_rad), "N m"},
          {"frequency", loads.periodic_rad_s, "rad/s"}};
}

Parameters hide_coupling(const HidingPlace& place) {
  JointLoads& loads = joint_of(place).loads;
  const bool belt = place.draws.below(2) == 1;
  const VectorXd other = place.survey.dq.col(1 - place.joint);
  if (belt) {
    loads.belt_nm = sized(place, 0.03, 0.09, VectorXd::Ones(other.size()));
    return {{"level", loads.belt_nm, "N m"}};
  }
  loads.coupling_nm_s_rad = place.draws.sign() * sized(place, 0.03, 0.09, other);
  return {{"coefficient", loads.coupling_nm_s_rad, "N m s/rad"}};
}

Parameters hide_drift(const HidingPlace& place) {
  JointFriction& friction = joint_of(place).friction;
  const double excess = place.size * place.draws.uniform(0.7, 1.5);
  friction.cold_coulomb_nm = excess * friction.coulomb_nm;
  friction.cold_viscous_nm_s_rad = excess * friction.viscous_nm_s_rad;
  friction.warming_s = place.draws.uniform(8.0, 20.0);
  return {{"level", friction.cold_coulomb_nm, "N m"},
          {"coefficient", friction.cold_viscous_nm_s_rad, "N m s/rad"},
          {"time_constant", friction.warming_s, "s"}};
}

using Hide = Parameters (*)(const HidingPlace&);

Hide hiding(HiddenEffect effect) {
  switch (effect) {
    case HiddenEffect::kCoulombFriction:
      return hide_coulomb;
    case HiddenEffect::kViscousFriction:
      return hide_viscous;
    case HiddenEffect::kQuadraticFriction:
      return hide_quadratic;
    case HiddenEffect::kStribeckFriction:
      return hide_stribeck;
    case HiddenEffect::kFrictionAsymmetry:
      return hide_asymmetry;
    case HiddenEffect::kLoadDependentFriction:
      return hide_load_friction;
    case HiddenEffect::kHysteresis:
      return hide_hysteresis;
    case HiddenEffect::kTorqueOffset:
      return hide_offset;
    case HiddenEffect::kTorqueScale:
      return hide_scale;
    case HiddenEffect::kRotorInertia:
      return hide_rotor;
    case HiddenEffect::kLinkMass:
      return hide_link_mass;
    case HiddenEffect::kTipPayload:
      return hide_payload;
    case HiddenEffect::kCoggingTorque:
      return hide_cogging;
    case HiddenEffect::kJointStiffness:
      return hide_spring;
    case HiddenEffect::kJointElasticity:
      return hide_elasticity;
    case HiddenEffect::kBacklash:
      return hide_backlash;
    case HiddenEffect::kTimeDelay:
      return hide_delay;
    case HiddenEffect::kPeriodicDisturbance:
      return hide_periodic;
    case HiddenEffect::kJointCoupling:
      return hide_coupling;
    case HiddenEffect::kTemperatureDrift:
      return hide_drift;
  }
  return nullptr;
}

}  // namespace

TrueEffect hide_effect(HiddenEffect effect, const HidingPlace& place) {
  return {effect, place.joint, hiding(effect)(place)};
}

}  // namespace offnominal::sim::hidden
