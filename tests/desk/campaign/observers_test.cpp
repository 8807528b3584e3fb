#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/model/inverse_dynamics.hpp>

#include "campaign/kdl_observer.hpp"
#include "campaign/momentum_observer.hpp"
#include "robot/chain_of.hpp"
#include "robot/robot_file.hpp"
#include "support/robots.hpp"

// The detectors of others, on recordings in which nothing is unknown but a torque.

namespace offnominal::desk::campaign {
namespace {

RobotDescription arm_with_friction() {
  RobotDescription robot = read_robot_file(test::kRobots / "two_link.toml");
  RobotEffect friction;
  friction.kind = EffectKind::kViscousFriction;
  friction.joint = 1;
  friction.parameters[0] = 0.8;
  robot.effects.push_back(friction);
  return robot;
}

// The model's own torques on a smooth motion, and `more` on joint 2 from 2 s on.
Log recording(const RobotDescription& robot, double more_nm) {
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  constexpr int kRows = 5000;
  Log log;
  log.period_s = 0.001;
  log.t_s = Eigen::VectorXd::LinSpaced(kRows, 0, (kRows - 1) * log.period_s);
  for (auto* columns : {&log.q, &log.dq, &log.tau}) columns->resize(kRows, 2);
  using Joints = Vector<kRuntimeJoints, double>;
  for (int row = 0; row < kRows; ++row) {
    const double t_s = log.t_s[row];
    Joints q(2), dq(2), ddq(2);
    for (int j = 0; j < 2; ++j) {
      const double rate = 1.5 + j;
      q[j] = 0.8 * std::sin(rate * t_s + j);
      dq[j] = 0.8 * rate * std::cos(rate * t_s + j);
      ddq[j] = -0.8 * rate * rate * std::sin(rate * t_s + j);
    }
    log.q.row(row) = q;
    log.dq.row(row) = dq;
    log.tau.row(row) = inverse_dynamics<kRuntimeJoints, double>(model, q, dq, ddq, t_s);
    if (t_s >= 2) log.tau(row, 1) += more_nm;
  }
  return log;
}

TEST(MomentumObserver, SaysNothingWhereTheModelKnowsAllAndShowsWhatItDoesNot) {
  const RobotDescription robot = arm_with_friction();
  EXPECT_LT(momentum_residual(robot, 10, recording(robot, 0)).cwiseAbs().maxCoeff(), 1e-3);
  const Eigen::MatrixXd residual = momentum_residual(robot, 10, recording(robot, 3));
  // A torque that the drive is told and the motion does not show: through a pole of 10 1/s.
  EXPECT_NEAR(residual(2100, 1), -3 * (1 - std::exp(-1.0)), 0.02);
  EXPECT_NEAR(residual(4999, 1), -3, 1e-3);
  EXPECT_LT(residual.col(0).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(KdlObserver, AgreesWithTheMomentumObserver) {
  const RobotDescription robot = arm_with_friction();
  const Log log = recording(robot, 3);
  const Eigen::MatrixXd residual = kdl_residual(robot, 10, 0, log);
  const Eigen::MatrixXd ours = momentum_residual(robot, 10, log);
  // It integrates by Euler's method.
  EXPECT_LT((residual - ours).cwiseAbs().maxCoeff(), 0.15);
  EXPECT_NEAR(residual(4999, 1), -3, 0.1);
  // Its filter is slower, and comes to the same.
  EXPECT_NEAR(kdl_residual(robot, 10, 0.5, log)(4999, 1), -3, 0.1);
}

}  // namespace
}  // namespace offnominal::desk::campaign
