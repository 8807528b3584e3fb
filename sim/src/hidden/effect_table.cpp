#include "offnominal/sim/hidden/effect_table.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Drawn = std::vector<DrawnNumber>;
using Values = std::vector<double>;

// Periods per turn of the joint: pole pairs, slots, teeth, and gear ratios times them.
constexpr std::array<int, 24> kCoggingOrders = {6,  7,  8,  9,  10, 11, 12, 14, 15, 16, 18, 20,
                                                21, 22, 24, 28, 30, 32, 36, 40, 42, 48, 60, 72};

constexpr double kNotHere = std::numeric_limits<double>::quiet_NaN();

RobotJoint& joint_of(const HidingPlace& place) {
  return place.robot.joints[static_cast<std::size_t>(place.joint)];
}

NominalJoint& known_of(const HidingPlace& place) {
  return place.nominal.joints[static_cast<std::size_t>(place.joint)];
}

double rms_of(const HidingPlace& place) { return place.survey.rms_nm[place.joint]; }

// Coefficient of a torque that is known along the survey, its share drawn.
double sized(const HidingPlace& place, const DrawnNumber& share, const VectorXd& unit_torque) {
  return place.size * place.survey.scale_to(place.draws.from(share), place.joint, unit_torque);
}

// A torque, its level drawn.
double level(const HidingPlace& place, const DrawnNumber& from) {
  return place.size * place.draws.from(from) * rms_of(place);
}

Values hide_coulomb(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  friction.coulomb_nm = level(place, drawn[0]);
  known_of(place).coulomb_nm = 0.0;
  return {friction.coulomb_nm};
}

Values hide_viscous(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  friction.viscous_nm_s_rad = sized(place, drawn[0], place.survey.dq.col(place.joint));
  known_of(place).viscous_nm_s_rad = 0.0;
  return {friction.viscous_nm_s_rad};
}

Values hide_quadratic(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  const VectorXd squared = place.survey.dq.col(place.joint).array().square();
  friction.quadratic_nm_s2_rad2 = sized(place, drawn[0], squared);
  return {friction.quadratic_nm_s2_rad2};
}

Values hide_stribeck(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  const double v = place.draws.from(drawn[1]);
  const VectorXd fall = (-(place.survey.dq.col(place.joint).array() / v).square()).exp();
  friction.stribeck_velocity_rad_s = v;
  friction.stribeck_nm = sized(place, drawn[0], fall);
  return {friction.stribeck_nm, v};
}

Values hide_asymmetry(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  const double side = place.draws.sign();
  const double level = side * place.draws.from(drawn[0]) * place.size;
  const double slope = side * place.draws.from(drawn[1]) * place.size;
  friction.coulomb_asymmetry_nm = level * friction.coulomb_nm;
  friction.viscous_asymmetry_nm_s_rad = slope * friction.viscous_nm_s_rad;
  return {friction.coulomb_asymmetry_nm, friction.viscous_asymmetry_nm_s_rad};
}

Values hide_load_friction(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  friction.per_load = place.size * place.draws.from(drawn[0]);
  return {friction.per_load};
}

Values hide_hysteresis(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  friction.soft_level_nm = level(place, drawn[0]);
  friction.soft_width_rad = place.draws.from(drawn[1]);
  return {friction.soft_level_nm, friction.soft_width_rad};
}

Values hide_offset(const HidingPlace& place, const Drawn& drawn) {
  JointLoads& loads = joint_of(place).loads;
  const double side = place.draws.sign();
  loads.offset_nm = side * level(place, drawn[0]);
  return {loads.offset_nm};
}

Values hide_scale(const HidingPlace& place, const Drawn& drawn) {
  const double side = place.draws.sign();
  const double share = side * place.size * place.draws.from(drawn[0]);
  joint_of(place).drive.scale = 1.0 + share;
  return {share};
}

Values hide_rotor(const HidingPlace& place, const Drawn& drawn) {
  const double inertia = sized(place, drawn[0], place.survey.ddq.col(place.joint));
  joint_of(place).transmission.rotor_inertia_kg_m2 = inertia;
  known_of(place).rotor_inertia_kg_m2 = 0.0;
  return {inertia};
}

Values hide_link_mass(const HidingPlace& place, const Drawn& drawn) {
  RigidLink& link = place.robot.links[static_cast<std::size_t>(place.joint)];
  const double mass = place.size * place.draws.from(drawn[0]) * link.mass_kg;
  link.mass_kg += mass;
  return {mass};
}

Values hide_payload(const HidingPlace& place, const Drawn& drawn) {
  const Survey& s = place.survey;
  const std::array<RigidLink, 2>& links = place.robot.links;
  std::array<RigidLink, 2> massless = links;
  for (RigidLink& link : massless) link.mass_kg = link.inertia_kg_m2 = 0.0;
  const PlanarArm unit_tip(massless, place.robot.gravity_m_s2, 1.0);
  VectorXd per_kg(s.tau.rows());
  for (Index k = 0; k < per_kg.size(); ++k) {
    per_kg[k] = unit_tip.torque(s.q.row(k), s.dq.row(k), s.ddq.row(k))[1];
  }
  const double mass = sized(place, drawn[0], per_kg);
  place.robot.tip_mass_kg = mass;
  return {mass, links[1].length_m};
}

Values hide_cogging(const HidingPlace& place, const Drawn& drawn) {
  JointLoads& loads = joint_of(place).loads;
  const int order =
      kCoggingOrders[static_cast<std::size_t>(place.draws.below(kCoggingOrders.size()))];
  loads.cogging_order = order;
  loads.cogging_phase_rad = place.draws.uniform(0.0, 2.0 * std::numbers::pi);
  const VectorXd wave =
      (loads.cogging_order * place.survey.q.col(place.joint).array() + loads.cogging_phase_rad)
          .sin();
  loads.cogging_nm = sized(place, drawn[0], wave);
  return {loads.cogging_nm * std::cos(loads.cogging_phase_rad),
          loads.cogging_nm * std::sin(loads.cogging_phase_rad), loads.cogging_order};
}

Values hide_spring(const HidingPlace& place, const Drawn& drawn) {
  JointLoads& loads = joint_of(place).loads;
  const auto q = place.survey.q.col(place.joint);
  loads.spring_rest_rad = q.mean() + place.draws.from(drawn[1]);
  loads.spring_nm_rad = sized(place, drawn[0], q.array() - loads.spring_rest_rad);
  return {loads.spring_nm_rad, loads.spring_rest_rad};
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

Values hide_elasticity(const HidingPlace& place, const Drawn& drawn) {
  JointTransmission& t = joint_of(place).transmission;
  constexpr double kProbeNmRad = 1e4;  // stiff enough for the first order to hold
  const VectorXd probe = place.survey.tau.col(place.joint) / kProbeNmRad;
  t.stiffness_nm_rad = kProbeNmRad / sized(place, drawn[0], torque_of_deflection(place, probe));
  const double damping_ratio = place.draws.from(drawn[1]);
  t.damping_nm_s_rad = 2.0 * damping_ratio * std::sqrt(t.stiffness_nm_rad * folded_inertia(place));
  return {t.stiffness_nm_rad, t.damping_nm_s_rad};
}

Values hide_backlash(const HidingPlace& place, const Drawn& drawn) {
  JointTransmission& t = joint_of(place).transmission;
  t.gap_rad = place.size * place.draws.from(drawn[0]);
  if (t.rigid()) {
    const double flank_rad_s = 2.0 * std::numbers::pi * 30.0;
    const double inertia = folded_inertia(place);
    t.stiffness_nm_rad = inertia * flank_rad_s * flank_rad_s;
    t.damping_nm_s_rad = 2.0 * 0.6 * inertia * flank_rad_s;
  }
  return {t.gap_rad};
}

Values hide_delay(const HidingPlace& place, const Drawn& drawn) {
  JointDrive& drive = joint_of(place).drive;
  // Whole tenths of a millisecond are whole substeps of the simulation: the delay is exact.
  drive.delay_s = 1e-4 * std::round(1e4 * place.size * place.draws.from(drawn[0]));
  return {drive.delay_s};
}

Values hide_periodic(const HidingPlace& place, const Drawn& drawn) {
  JointLoads& loads = joint_of(place).loads;
  loads.periodic_rad_s = 2.0 * std::numbers::pi * place.draws.from(drawn[1]);
  loads.periodic_phase_rad = place.draws.uniform(0.0, 2.0 * std::numbers::pi);
  loads.periodic_nm = place.size * std::numbers::sqrt2 * place.draws.from(drawn[0]) * rms_of(place);
  return {loads.periodic_nm * std::cos(loads.periodic_phase_rad),
          loads.periodic_nm * std::sin(loads.periodic_phase_rad), loads.periodic_rad_s};
}

Values hide_coupling(const HidingPlace& place, const Drawn& drawn) {
  JointLoads& loads = joint_of(place).loads;
  const bool belt = place.draws.below(2) == 1;
  const VectorXd other = place.survey.dq.col(1 - place.joint);
  if (belt) {
    loads.belt_nm = sized(place, drawn[0], VectorXd::Ones(other.size()));
    return {kNotHere, loads.belt_nm};
  }
  const double side = place.draws.sign();
  loads.coupling_nm_s_rad = side * sized(place, drawn[0], other);
  return {loads.coupling_nm_s_rad, kNotHere};
}

Values hide_drift(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  const double excess = place.size * place.draws.from(drawn[0]);
  friction.cold_coulomb_nm = excess * friction.coulomb_nm;
  friction.cold_viscous_nm_s_rad = excess * friction.viscous_nm_s_rad;
  friction.warming_s = place.draws.from(drawn[1]);
  return {friction.cold_coulomb_nm, friction.cold_viscous_nm_s_rad, friction.warming_s};
}

Values hide_gear_loss(const HidingPlace& place, const Drawn& drawn) {
  JointFriction& friction = joint_of(place).friction;
  friction.driven_loss = place.size * place.draws.from(drawn[0]);
  friction.driving_loss = place.size * place.draws.from(drawn[1]);
  return {friction.driven_loss, friction.driving_loss};
}

Values hide_gas_spring(const HidingPlace& place, const Drawn& drawn) {
  GasSpring& spring = joint_of(place).loads.gas_spring;
  const auto q = place.survey.q.col(place.joint);
  spring.dead_centre_rad = q.mean() + place.draws.from(drawn[1]);
  spring.pin_m = place.draws.from(drawn[2]) * spring.foot_m;
  spring.force_n = 1.0;
  VectorXd per_newton(q.size());
  for (Index k = 0; k < q.size(); ++k) per_newton[k] = spring.torque(q[k]);
  spring.force_n = sized(place, drawn[0], per_newton);
  return {spring.force_n, spring.pin_m, spring.dead_centre_rad};
}

}  // namespace

const std::vector<HiddenEffectRow>& hidden_effect_table() {
  using enum HiddenEffect;
  static const std::vector<HiddenEffectRow> rows = {
      {kCoulombFriction,
       "coulomb_friction",
       {{"level", 0.05, 0.14}},
       "",
       {{"level", "N m"}},
       hide_coulomb},
      {kViscousFriction,
       "viscous_friction",
       {{"share", 0.04, 0.12}},
       "",
       {{"coefficient", "N m s/rad"}},
       hide_viscous},
      {kQuadraticFriction,
       "quadratic_friction",
       {{"share", 0.04, 0.12}},
       "",
       {{"coefficient", "N m s^2/rad^2"}},
       hide_quadratic},
      // Static less Coulomb.
      {kStribeckFriction,
       "stribeck_friction",
       {{"share", 0.03, 0.07}, {"velocity", 0.1, 0.4, "rad/s", true}},
       "",
       {{"level", "N m"}, {"stribeck_velocity", "rad/s"}},
       hide_stribeck},
      // Half the differences, + less -.
      {kFrictionAsymmetry,
       "friction_asymmetry",
       {{"part of the Coulomb level", 0.3, 0.7}, {"part of the viscous coefficient", 0.3, 0.7}},
       "of one sign, either",
       {{"level", "N m"}, {"coefficient", "N m s/rad"}},
       hide_asymmetry},
      // Friction per gear load.
      {kLoadDependentFriction,
       "load_dependent_friction",
       {{"coefficient", 0.04, 0.12}},
       "",
       {{"coefficient", ""}},
       hide_load_friction},
      // The width is the distance over which 63 % of a reversal is done.
      {kHysteresis,
       "hysteresis",
       {{"level", 0.06, 0.15}, {"width", 0.05, 0.2, "rad", true}},
       "",
       {{"level", "N m"}, {"width", "rad"}},
       hide_hysteresis},
      {kTorqueOffset,
       "torque_offset",
       {{"level", 0.03, 0.1}},
       "either sign",
       {{"level", "N m"}},
       hide_offset},
      // The drive gives (1 + share) times what is logged.
      {kTorqueScale,
       "torque_scale",
       {{"excess of what the drive gives", 0.06, 0.2}},
       "either sign",
       {{"share", ""}},
       hide_scale},
      {kRotorInertia,
       "rotor_inertia",
       {{"share", 0.04, 0.12}},
       "",
       {{"inertia", "kg m^2"}},
       hide_rotor},
      // At the centre of mass of link `joint`.
      {kLinkMass,
       "link_mass",
       {{"part of the link", 0.12, 0.4}},
       "",
       {{"mass", "kg"}},
       hide_link_mass},
      // In the frame of link 2.
      {kTipPayload,
       "tip_payload",
       {{"share", 0.08, 0.18}},
       "at joint 2",
       {{"mass", "kg"}, {"x", "m"}},
       hide_payload},
      // sine sin(order q) + cosine cos(order q).
      {kCoggingTorque,
       "cogging_torque",
       {{"share", 0.03, 0.09}},
       "order 6 to 72 per turn",
       {{"sine", "N m"}, {"cosine", "N m"}, {"order", "1/turn"}},
       hide_cogging},
      {kJointStiffness,
       "joint_stiffness",
       {{"share", 0.04, 0.12}, {"rest from the mean position", -0.5, 0.5, "rad"}},
       "",
       {{"stiffness", "N m/rad"}, {"rest_position", "rad"}},
       hide_spring},
      // The share is that of the deflection, ringing apart.
      {kJointElasticity,
       "joint_elasticity",
       {{"share", 0.02, 0.06}, {"damping ratio", 0.04, 0.1}},
       "",
       {{"stiffness", "N m/rad"}, {"damping", "N m s/rad"}},
       hide_elasticity},
      // Full width, with flanks of 30 Hz with the link.
      {kBacklash, "backlash", {{"gap", 0.004, 0.025, "rad"}}, "", {{"gap", "rad"}}, hide_backlash},
      // The drive executes the logged torque this late.
      {kTimeDelay, "time_delay", {{"delay", 0.002, 0.006, "s"}}, "", {{"delay", "s"}}, hide_delay},
      // t = 0 starts the log.
      {kPeriodicDisturbance,
       "periodic_disturbance",
       {{"share", 0.03, 0.09}, {"frequency", 1.0, 15.0, "Hz", true}},
       "",
       {{"sine", "N m"}, {"cosine", "N m"}, {"frequency", "rad/s"}},
       hide_periodic},
      // Times the other joint's velocity, or with its direction.
      {kJointCoupling,
       "joint_coupling",
       {{"share", 0.03, 0.09}},
       "by velocity, either sign, or by direction",
       {{"coefficient", "N m s/rad"}, {"level", "N m"}},
       hide_coupling},
      // The excess of Coulomb and viscous friction at the start of each log, which then decays.
      {kTemperatureDrift,
       "temperature_drift",
       {{"part of Coulomb and viscous friction", 0.7, 1.5}, {"time constant", 8.0, 20.0, "s"}},
       "",
       {{"level", "N m"}, {"coefficient", "N m s/rad"}, {"time_constant", "s"}},
       hide_drift},
      // Larger than the others, up to 45 % of the joint's torque: within the 3 % that the masses
      // are off, a difference of the two losses is a heavier or a lighter arm.
      {kGearLoss,
       "gear_loss",
       {{"loss driven back", 0.25, 0.45}, {"loss driving", 0.05, 0.15}},
       "",
       {{"driven_loss", ""}, {"driving_loss", ""}},
       hide_gear_loss},
      // A gas spring; its curve over the position is what a robot file can have of it.
      {kPositionTorque,
       "position_torque",
       {{"share", 0.08, 0.2},
        {"dead centre from the mean position", -0.5, 0.5, "rad"},
        {"pin per foot", 0.55, 0.75}},
       "a gas spring",
       {{"force", "N"}, {"pin", "m"}, {"dead_centre", "rad"}},
       hide_gas_spring},
  };
  return rows;
}

const HiddenEffectRow& row_of(HiddenEffect effect) {
  return hidden_effect_table().at(static_cast<std::size_t>(effect));
}

std::vector<HiddenEffect> all_hidden_effects() {
  std::vector<HiddenEffect> all;
  for (const HiddenEffectRow& row : hidden_effect_table()) all.push_back(row.effect);
  return all;
}

}  // namespace offnominal::sim::hidden
