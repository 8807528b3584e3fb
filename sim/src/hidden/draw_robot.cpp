#include "offnominal/sim/hidden/draw_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "offnominal/sim/hidden/closed_loop.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kSurveyS = 30.0;
constexpr double kReachRad = 2.0;   // of every drawn motion from its centre, at most
constexpr double kSpeedRadS = 6.5;  // of every drawn motion, at most
constexpr double kRigidBodyError = 0.03;
constexpr double kFrictionError = 0.1;

double off_by(double error, Draws& draws) { return 1.0 + draws.uniform(-error, error); }

NominalLink drawn_link(double mass_low, double mass_high, double length_low, double length_high,
                       Draws& draws) {
  NominalLink link;
  link.mass_kg = draws.uniform(mass_low, mass_high);
  link.length_m = draws.uniform(length_low, length_high);
  link.centre_of_mass_m = link.length_m * draws.uniform(0.4, 0.6);
  const double rod_m = link.length_m * draws.uniform(0.7, 1.1);
  link.inertia_kg_m2 = link.mass_kg * rod_m * rod_m / 12.0;
  return link;
}

double rounded_up(double value) {
  const double step = value > 40.0 ? 5.0 : 1.0;
  return step * std::ceil(value / step);
}

// Arm as its owner knows it and as it is, without friction.
void draw_arm(Draws& draws, Draws& knowledge, DrawnRobot& drawn) {
  drawn.nominal.links = {drawn_link(2.0, 6.0, 0.35, 0.6, draws),
                         drawn_link(1.0, 4.0, 0.3, 0.5, draws)};
  for (std::size_t j = 0; j < 2; ++j) {
    const NominalLink& known = drawn.nominal.links[j];
    const double factor = off_by(kRigidBodyError, knowledge);
    drawn.robot.links[j] = {factor * known.mass_kg, known.length_m, known.centre_of_mass_m,
                            factor * known.inertia_kg_m2};
  }
  drawn.robot.gravity_m_s2 = drawn.nominal.gravity_m_s2;
  drawn.centre_rad = {-0.5 * std::numbers::pi + draws.uniform(-0.6, 0.6), draws.uniform(-0.6, 0.6)};
  const Eigen::Matrix2d folded =
      drawn.robot.arm().terms({0.0, 0.5 * std::numbers::pi}, {0.0, 0.0}).mass;
  for (std::size_t j = 0; j < 2; ++j) {
    const auto i = static_cast<Index>(j);
    const double rotor = folded(i, i) * draws.uniform(0.2, 0.5);
    drawn.robot.joints[j].transmission.rotor_inertia_kg_m2 = rotor;
    NominalJoint& known = drawn.nominal.joints[j];
    known.rotor_inertia_kg_m2 = rotor / off_by(kRigidBodyError, knowledge);
    known.position_min_rad = drawn.centre_rad[i] - kReachRad;
    known.position_max_rad = drawn.centre_rad[i] + kReachRad;
    known.velocity_limit_rad_s = kSpeedRadS;
  }
}

void draw_friction(const Survey& survey, Draws& draws, Draws& knowledge, DrawnRobot& drawn) {
  for (int j = 0; j < 2; ++j) {
    const auto i = static_cast<std::size_t>(j);
    JointFriction& friction = drawn.robot.joints[i].friction;
    friction.coulomb_nm = survey.rms_nm[j] * draws.uniform(0.06, 0.12);
    friction.viscous_nm_s_rad = survey.scale_to(draws.uniform(0.04, 0.1), j, survey.dq.col(j));
    friction.width_rad = draws.log_uniform(5e-5, 2e-4);
    NominalJoint& known = drawn.nominal.joints[i];
    known.coulomb_nm = friction.coulomb_nm / off_by(kFrictionError, knowledge);
    known.viscous_nm_s_rad = friction.viscous_nm_s_rad / off_by(kFrictionError, knowledge);
  }
}

void set_torque_limits(const Survey& survey, Nominal& nominal) {
  Vector2d peak = Vector2d::Zero();
  for (Index k = 0; k < survey.q.rows(); ++k) {
    const DesiredMotion m{survey.q.row(k), survey.dq.row(k), survey.ddq.row(k)};
    peak = peak.cwiseMax(nominal_torque(nominal, m).cwiseAbs());
  }
  for (int j = 0; j < 2; ++j) {
    nominal.joints[static_cast<std::size_t>(j)].torque_limit_nm = rounded_up(2.0 * peak[j]);
  }
}

bool softens(HiddenEffect effect) {
  return effect == HiddenEffect::kJointElasticity || effect == HiddenEffect::kBacklash;
}

// A late drive in front of a soft joint would need other gains: nobody runs a robot like that.
bool clash(HiddenEffect a, HiddenEffect b) {
  return (a == HiddenEffect::kTimeDelay && softens(b)) ||
         (b == HiddenEffect::kTimeDelay && softens(a));
}

int drawn_joint(HiddenEffect effect, const std::vector<TrueEffect>& earlier, Draws& draws) {
  int joint = draws.below(2);
  if (effect == HiddenEffect::kTipPayload) joint = 1;
  for (const TrueEffect& other : earlier) {
    if (clash(effect, other.effect)) joint = 1 - other.joint;
  }
  return joint;
}

template <typename Row>
std::vector<TrueParameter> hide(const Row& row, const HidingPlace& place) {
  const std::vector<double> values = row.hide(place, row.drawn);
  std::vector<TrueParameter> parameters;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    parameters.push_back({std::string(row.parameters.at(i).name), values[i],
                          std::string(row.parameters.at(i).unit)});
  }
  return parameters;
}

void hide_all(const Request& request, const Survey& survey, DrawnRobot& drawn) {
  std::vector<TrueEffect> hidden;
  for (const HiddenEffectRow& row : hidden_effect_table()) {
    const HiddenEffect effect = row.effect;
    if (std::find(request.effects.begin(), request.effects.end(), effect) ==
        request.effects.end()) {
      continue;
    }
    Draws draws(request.seed, Stream::kEffects, static_cast<std::uint64_t>(effect));
    const int joint = drawn_joint(effect, hidden, draws);
    hidden.push_back(
        {effect, joint,
         hide(row, {joint, request.effect_size, survey, draws, drawn.robot, drawn.nominal})});
  }
  for (const HiddenEffect effect : request.effects) {
    drawn.truth.effects.push_back(
        *std::find_if(hidden.begin(), hidden.end(),
                      [effect](const TrueEffect& found) { return found.effect == effect; }));
  }
  if (request.outside == OutsideEffect::kNone) return;
  Draws draws(request.seed, Stream::kOutside, static_cast<std::uint64_t>(request.outside));
  const int joint = draws.below(2);
  drawn.truth.outside = {request.outside, joint,
                         hide(row_of(request.outside), {joint, request.effect_size, survey, draws,
                                                        drawn.robot, drawn.nominal})};
}

}  // namespace

double Survey::scale_to(double share, int joint, const Eigen::VectorXd& unit_torque) const {
  const double unit_rms = std::sqrt(unit_torque.squaredNorm() / static_cast<double>(tau.rows()));
  return share * rms_nm[joint] / unit_rms;
}

Survey survey(const Robot& robot, const Motion& motion) {
  const auto n = static_cast<Index>(kSurveyS * kSurveyRateHz);
  Survey s;
  for (Eigen::MatrixXd* m : {&s.q, &s.dq, &s.ddq, &s.tau}) m->resize(n, 2);
  const PlanarArm arm = robot.arm();
  const Vector2d rotors(robot.joints[0].transmission.rotor_inertia_kg_m2,
                        robot.joints[1].transmission.rotor_inertia_kg_m2);
  for (Index k = 0; k < n; ++k) {
    const DesiredMotion m = motion(static_cast<double>(k) / kSurveyRateHz);
    s.q.row(k) = m.q.transpose();
    s.dq.row(k) = m.dq.transpose();
    s.ddq.row(k) = m.ddq.transpose();
    s.tau.row(k) = (arm.torque(m.q, m.dq, m.ddq) + rotors.cwiseProduct(m.ddq)).transpose();
  }
  s.rms_nm = (s.tau.colwise().squaredNorm() / static_cast<double>(n)).cwiseSqrt().transpose();
  return s;
}

DrawnRobot draw_robot(const Request& request) {
  validate(request);
  DrawnRobot drawn;
  Draws draws(request.seed, Stream::kArm);
  Draws knowledge(request.seed, Stream::kKnowledge);
  draw_arm(draws, knowledge, drawn);
  Draws motion_draws(request.seed, Stream::kMotion);
  const Survey seen = survey(drawn.robot, rich_motion(drawn.centre_rad, motion_draws));
  draw_friction(seen, draws, knowledge, drawn);
  set_torque_limits(seen, drawn.nominal);
  drawn.nominal.encoder_bits = request.encoder_bits;
  drawn.truth.fault = request.fault;
  hide_all(request, seen, drawn);
  return drawn;
}

Motion drawn_motion(const Request& request, const Vector2d& centre_rad, Stream stream) {
  Draws draws(request.seed, stream);
  return request.excitation == Excitation::kRich ? rich_motion(centre_rad, draws)
                                                 : poor_motion(centre_rad, draws);
}

}  // namespace offnominal::sim::hidden
