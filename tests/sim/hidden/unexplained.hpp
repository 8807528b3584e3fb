// What a hidden effect amounts to: the logged torque less that of the same robot without the
// effect, on the motion that the encoders could see.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "offnominal/sim/hidden/bristle.hpp"
#include "offnominal/sim/hidden/closed_loop.hpp"
#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden::test {

/// The robot without the request's effects; known friction that is the hidden effect is taken out.
inline Robot baseline(Request request, const Truth& truth) {
  request.effects.clear();
  request.outside = OutsideEffect::kNone;
  Robot robot = draw_robot(request).robot;
  for (const TrueEffect& hidden : truth.effects) {
    RobotJoint& joint = robot.joints[static_cast<std::size_t>(hidden.joint)];
    if (hidden.effect == HiddenEffect::kCoulombFriction) joint.friction.coulomb_nm = 0.0;
    if (hidden.effect == HiddenEffect::kViscousFriction) joint.friction.viscous_nm_s_rad = 0.0;
    if (hidden.effect == HiddenEffect::kRotorInertia) joint.transmission.rotor_inertia_kg_m2 = 0.0;
  }
  return robot;
}

/// Coulomb and viscous friction of the motion, mean over each sample, N m.
inline Eigen::VectorXd friction_along(const JointFriction& f, const Eigen::VectorXd& dq,
                                      double period_s) {
  const Bristle bristle(f.width_rad, 0.0, 0.0);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(dq.size());
  double stretch = 0.0;
  constexpr int kParts = 4;
  for (Eigen::Index k = 0; k + 1 < dq.size(); ++k) {
    for (int i = 0; i < kParts; ++i) {
      const double v = dq[k] + (dq[k + 1] - dq[k]) * (i + 0.5) / kParts;
      stretch = bristle.advance(stretch, v, period_s / kParts);
      torque[k] += (bristle.torque(stretch, v, f.coulomb_nm) + f.viscous_nm_s_rad * v) / kParts;
    }
  }
  return torque;
}

/// Commanded torque less the baseline's, n - 1 rows, N m.
inline Eigen::MatrixXd unexplained(const Robot& baseline, const Trace& trace) {
  const Eigen::Index n = trace.t_s.size();
  const double period_s = trace.t_s[1] - trace.t_s[0];
  const PlanarArm arm = baseline.arm();
  Eigen::MatrixXd rest = trace.commanded_nm.topRows(n - 1);
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    const Eigen::Vector2d q = 0.5 * (trace.motor_q.row(k) + trace.motor_q.row(k + 1));
    const Eigen::Vector2d dq = 0.5 * (trace.motor_dq.row(k) + trace.motor_dq.row(k + 1));
    const Eigen::Vector2d ddq = (trace.motor_dq.row(k + 1) - trace.motor_dq.row(k)) / period_s;
    rest.row(k) -= arm.torque(q, dq, ddq).transpose();
    for (int j = 0; j < 2; ++j) {
      rest(k, j) -=
          baseline.joints[static_cast<std::size_t>(j)].transmission.rotor_inertia_kg_m2 * ddq[j];
    }
  }
  for (int j = 0; j < 2; ++j) {
    rest.col(j) -= friction_along(baseline.joints[static_cast<std::size_t>(j)].friction,
                                  trace.motor_dq.col(j), period_s)
                       .head(n - 1);
  }
  return rest;
}

inline double rms(const Eigen::VectorXd& x) {
  return std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

/// What is left below about 20 Hz: two first-order filters forward and two backward.
inline Eigen::VectorXd slow_part(Eigen::VectorXd x, double period_s) {
  const double follow = 1.0 - std::exp(-2.0 * std::numbers::pi * 20.0 * period_s);
  for (int pass = 0; pass < 4; ++pass) {
    double y = x[0];
    for (double& value : x) value = y += follow * (value - y);
    x.reverseInPlace();
  }
  return x;
}

inline Trace trace_of(const DrawnRobot& drawn, const Request& request) {
  return run_closed_loop(
      drawn.robot, drawn.nominal, drawn_motion(request, drawn.centre_rad, Stream::kMotion),
      draw_contacts(drawn.robot, request.duration_s, Draws(request.seed, Stream::kContact)),
      {request.duration_s, request.sample_rate_hz, request.encoder_bits});
}

/// Root mean square of the unexplained torque over that of the logged torque.
struct Share {
  double own = 0.0;       ///< at the effect's joint
  double own_slow = 0.0;  ///< there, below 20 Hz
  double other = 0.0;     ///< at the other joint
};

inline Share share(const Request& request) {
  const DrawnRobot drawn = draw_robot(request);
  const int joint =
      drawn.truth.effects.empty() ? drawn.truth.outside.joint : drawn.truth.effects[0].joint;
  const Trace trace = trace_of(drawn, request);
  const Eigen::MatrixXd rest = unexplained(baseline(request, drawn.truth), trace);
  const double whole = rms(trace.commanded_nm.col(joint));
  return {rms(rest.col(joint)) / whole,
          rms(slow_part(rest.col(joint), 1.0 / request.sample_rate_hz)) / whole,
          rms(rest.col(1 - joint)) / rms(trace.commanded_nm.col(1 - joint))};
}

}  // namespace offnominal::sim::hidden::test
