#include "offnominal/sim/hidden/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "offnominal/sim/encoder.hpp"
#include "offnominal/sim/plants/hidden_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kLoopRadS = 18.0;  // natural frequency of the position loop
constexpr double kLoopDamping = 0.8;
constexpr double kDifferencePoleRadS = 2.0 * std::numbers::pi * 12.0;
constexpr double kSignSpeedRadS = 0.03;

PlanarArm nominal_arm(const Nominal& nominal) {
  std::array<RigidLink, 2> links;
  for (std::size_t j = 0; j < 2; ++j) {
    const NominalLink& link = nominal.links[j];
    links[j] = {link.mass_kg, link.length_m, link.centre_of_mass_m, link.inertia_kg_m2};
  }
  return {links, nominal.gravity_m_s2};
}

Vector2d nominal_torque_of(const PlanarArm& arm, const Nominal& nominal,
                           const DesiredMotion& motion) {
  Vector2d tau = arm.torque(motion.q, motion.dq, motion.ddq);
  for (int j = 0; j < 2; ++j) {
    const NominalJoint& joint = nominal.joints[static_cast<std::size_t>(j)];
    const double v = motion.dq[j];
    tau[j] += joint.rotor_inertia_kg_m2 * motion.ddq[j] + joint.viscous_nm_s_rad * v +
              joint.coulomb_nm * std::tanh(v / kSignSpeedRadS);
  }
  return tau;
}

// Decoupled PD loop per joint on the inertia that the nominal model has with the arm stretched out.
class Controller {
 public:
  Controller(const Nominal& nominal, double period_s)
      : nominal_(nominal), arm_(nominal_arm(nominal)), period_s_(period_s) {
    const Eigen::Matrix2d stretched = arm_.terms({0.0, 0.0}, {0.0, 0.0}).mass;
    for (int j = 0; j < 2; ++j) {
      const double inertia =
          stretched(j, j) + nominal.joints[static_cast<std::size_t>(j)].rotor_inertia_kg_m2;
      kp_[j] = inertia * kLoopRadS * kLoopRadS;
      kd_[j] = 2.0 * kLoopDamping * inertia * kLoopRadS;
    }
    follow_ = 1.0 - std::exp(-kDifferencePoleRadS * period_s);
  }

  Vector2d command(const DesiredMotion& desired, const Vector2d& measured_q) {
    const Vector2d error = desired.q - measured_q;
    if (started_) error_rate_ += follow_ * ((error - last_error_) / period_s_ - error_rate_);
    started_ = true;
    last_error_ = error;
    Vector2d tau = nominal_torque_of(arm_, nominal_, desired) + kp_.cwiseProduct(error) +
                   kd_.cwiseProduct(error_rate_);
    for (int j = 0; j < 2; ++j) {
      const double limit = nominal_.joints[static_cast<std::size_t>(j)].torque_limit_nm;
      tau[j] = std::clamp(tau[j], -limit, limit);
    }
    return tau;
  }

 private:
  Nominal nominal_;
  PlanarArm arm_;
  double period_s_;
  double follow_ = 1.0;
  Vector2d kp_ = Vector2d::Zero(), kd_ = Vector2d::Zero();
  Vector2d last_error_ = Vector2d::Zero(), error_rate_ = Vector2d::Zero();
  bool started_ = false;
};

Trace empty_trace(Index n) {
  Trace trace;
  trace.t_s.resize(n);
  for (Eigen::MatrixXd* m : {&trace.encoder_q, &trace.commanded_nm, &trace.given_nm, &trace.motor_q,
                             &trace.motor_dq, &trace.link_q, &trace.link_dq, &trace.desired_q}) {
    m->setZero(n, 2);
  }
  return trace;
}

void note_state(const PlantState& state, const DesiredMotion& desired, Index k, Trace& trace) {
  trace.motor_q.row(k) = state.motor_q.transpose();
  trace.motor_dq.row(k) = state.motor_dq.transpose();
  trace.link_q.row(k) = state.link_q.transpose();
  trace.link_dq.row(k) = state.link_dq.transpose();
  trace.desired_q.row(k) = desired.q.transpose();
}

}  // namespace

Vector2d nominal_torque(const Nominal& nominal, const DesiredMotion& motion) {
  return nominal_torque_of(nominal_arm(nominal), nominal, motion);
}

Trace run_closed_loop(const Robot& robot, const Nominal& nominal, const Motion& motion,
                      const std::vector<Contact>& contacts, const LoopSettings& settings) {
  const double period_s = 1.0 / settings.sample_rate_hz;
  const auto n = static_cast<Index>(std::llround(settings.duration_s * settings.sample_rate_hz));
  const double count_rad = position_step_rad({settings.encoder_bits});
  Controller controller(nominal, period_s);
  HiddenRobot plant(robot, contacts, motion(0.0));
  Trace trace = empty_trace(n);
  for (Index k = 0; k < n; ++k) {
    const double t_s = static_cast<double>(k) * period_s;
    const DesiredMotion desired = motion(t_s);
    const Vector2d measured(quantise(plant.state().q[0], count_rad),
                            quantise(plant.state().q[1], count_rad));
    trace.t_s[k] = t_s;
    trace.encoder_q.row(k) = measured.transpose();
    trace.commanded_nm.row(k) = controller.command(desired, measured).transpose();
    note_state(plant.inner_state(), desired, k, trace);
    plant.step(t_s, trace.commanded_nm.row(k).transpose(), period_s);
    trace.given_nm.row(k) = plant.given_nm().transpose();
  }
  return trace;
}

}  // namespace offnominal::sim::hidden
