// The hidden robot under its controller: feed-forward of the nominal model and a PD loop on the
// encoders, sampled, with a drive that holds each torque until the next sample.
#pragma once

#include <Eigen/Core>

#include "offnominal/sim/hidden/case.hpp"
#include "offnominal/sim/hidden/motion.hpp"
#include "offnominal/sim/hidden/plant.hpp"

namespace offnominal::sim::hidden {

struct LoopSettings {
  double duration_s = 30.0;
  double sample_rate_hz = 1000.0;
  int encoder_bits = 19;
};

/// Everything that happened, without noise. Row k: at time t_s[k].
struct Trace {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd encoder_q;     ///< rad, rounded to counts
  Eigen::MatrixXd commanded_nm;  ///< held from t_s[k] on
  Eigen::MatrixXd given_nm;      ///< mean of what the motors gave from t_s[k] to t_s[k+1]
  Eigen::MatrixXd motor_q, motor_dq, link_q, link_dq;
  Eigen::MatrixXd desired_q;
};

/// Nominal torque of a motion: rigid arm, rotors, and friction by the sign of the velocity smoothed
/// over 0.03 rad/s.
Eigen::Vector2d nominal_torque(const Nominal& nominal, const DesiredMotion& motion);

/// Throws std::runtime_error when the motion runs away (position beyond 100 rad or not a number).
Trace run_closed_loop(const Robot& robot, const Nominal& nominal, const Motion& motion,
                      const std::vector<Contact>& contacts, const LoopSettings& settings);

}  // namespace offnominal::sim::hidden
