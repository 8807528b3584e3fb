#include "offnominal/sim/hidden/closed_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "unexplained.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Index;

Motion at_rest(const Eigen::Vector2d& q) {
  return [q](double) { return DesiredMotion{q, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()}; };
}

TEST(HiddenLoop, StaysWithinLimitsAndTracksWithAnyEffect) {
  const std::vector<HiddenEffect> all = all_hidden_effects();
  for (std::size_t i = 0; i < all.size(); ++i) {
    Request request{100 + i, {all[i], all[(i + 7) % all.size()]}};
    request.duration_s = 5.0;
    request.encoder_bits = i % 2 == 0 ? 19 : 13;
    const DrawnRobot drawn = draw_robot(request);
    const Trace trace = test::trace_of(drawn, request);
    EXPECT_LT((trace.motor_q - trace.desired_q).cwiseAbs().maxCoeff(), 0.08) << i;
    for (Index j = 0; j < 2; ++j) {
      const NominalJoint& limits = drawn.nominal.joints[static_cast<std::size_t>(j)];
      EXPECT_LT(trace.commanded_nm.col(j).cwiseAbs().maxCoeff(), 0.95 * limits.torque_limit_nm);
      EXPECT_LT(trace.motor_dq.col(j).cwiseAbs().maxCoeff(), limits.velocity_limit_rad_s);
      EXPECT_LT(trace.link_q.col(j).maxCoeff(), limits.position_max_rad);
      EXPECT_GT(trace.link_q.col(j).minCoeff(), limits.position_min_rad);
    }
  }
}

TEST(HiddenLoop, NominalModelIsTheRobotWithinItsTolerances) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Request request{seed, {}};
    request.duration_s = 3.0;
    const DrawnRobot drawn = draw_robot(request);
    for (std::size_t j = 0; j < 2; ++j) {
      const RigidLink& link = drawn.robot.links[j];
      const NominalLink& known = drawn.nominal.links[j];
      const double factor = link.mass_kg / known.mass_kg;
      EXPECT_NEAR(factor, 1.0, 0.03);
      EXPECT_NE(factor, 1.0);
      EXPECT_NEAR(link.inertia_kg_m2 / known.inertia_kg_m2, factor, 1e-12);
      const JointFriction& friction = drawn.robot.joints[j].friction;
      const NominalJoint& joint = drawn.nominal.joints[j];
      EXPECT_NEAR(friction.coulomb_nm / joint.coulomb_nm, 1.0, 0.1);
      EXPECT_NEAR(friction.viscous_nm_s_rad / joint.viscous_nm_s_rad, 1.0, 0.1);
    }
  }
}

TEST(HiddenLoop, DelayedDriveExecutesTheLogExactlyLate) {
  Request request{3, {HiddenEffect::kTimeDelay}};
  const DrawnRobot drawn = draw_robot(request);
  const int joint = drawn.truth.effects[0].joint;
  DrawnRobot late = drawn;
  late.robot.joints[static_cast<std::size_t>(joint)].drive.delay_s = 0.0034;
  request.duration_s = 1.0;
  const Trace trace = test::trace_of(late, request);
  for (Index k = 10; k < trace.t_s.size(); ++k) {
    // 3.4 ms: for 0.4 of the sample the torque of 4 samples ago, then that of 3 ago.
    const double given =
        0.4 * trace.commanded_nm(k - 4, joint) + 0.6 * trace.commanded_nm(k - 3, joint);
    ASSERT_NEAR(trace.given_nm(k, joint), given, 1e-9) << k;
    ASSERT_NEAR(trace.given_nm(k, 1 - joint), trace.commanded_nm(k, 1 - joint), 1e-9) << k;
  }
}

TEST(HiddenLoop, DriveScalesAndSaturates) {
  Request request{3, {}};
  request.duration_s = 2.0;
  DrawnRobot drawn = draw_robot(request);
  drawn.robot.joints[0].drive = {1.1, 0.0, 1.0, 0.8};
  const Trace trace = test::trace_of(drawn, request);
  for (Index k = 0; k < trace.t_s.size(); ++k) {
    const double logged = trace.commanded_nm(k, 0);
    const double beyond = std::max(0.0, std::abs(logged) - 1.0);
    ASSERT_NEAR(trace.given_nm(k, 0), 1.1 * std::copysign(std::abs(logged) - 0.2 * beyond, logged),
                1e-9);
  }
}

TEST(HiddenLoop, EncoderCountsMotorTurns) {
  Request request{5, {HiddenEffect::kJointElasticity}};
  request.duration_s = 1.0;
  request.encoder_bits = 12;
  const Trace trace = test::trace_of(draw_robot(request), request);
  const double count = 2.0 * std::numbers::pi / 4096.0;
  const Eigen::MatrixXd counts = trace.encoder_q / count;
  EXPECT_LT((counts.array() - counts.array().round()).abs().maxCoeff(), 1e-6);
  EXPECT_LT((trace.encoder_q - trace.motor_q).cwiseAbs().maxCoeff(), 0.5001 * count);
}

TEST(HiddenLoop, HeldPoseNeedsItsWeight) {
  Request request{8, {}};
  const DrawnRobot drawn = draw_robot(request);
  Robot smooth = drawn.robot;
  for (RobotJoint& joint : smooth.joints) joint.friction.coulomb_nm = 0.0;
  const Eigen::Vector2d q(-0.9, 0.4);
  const Trace trace = run_closed_loop(smooth, drawn.nominal, at_rest(q), {}, {3.0, 1000.0, 32});
  const Eigen::Vector2d held = trace.commanded_nm.row(2999);
  const Eigen::Vector2d weight =
      smooth.arm().terms(trace.motor_q.row(2999), Eigen::Vector2d::Zero()).bias;
  EXPECT_LT((held - weight).norm(), 1e-3 * weight.norm());
}

TEST(HiddenLoop, SaysWhenTheMotionRunsAway) {
  const DrawnRobot drawn = draw_robot({8, {}});
  Robot wild = drawn.robot;
  wild.joints[1].drive.scale = -1.0;
  wild.joints[1].friction = {};
  wild.gravity_m_s2 = 0.0;
  EXPECT_THROW(run_closed_loop(wild, drawn.nominal, at_rest({0.0, 0.5}), {}, {30.0, 1000.0, 19}),
               std::runtime_error);
}

}  // namespace
}  // namespace offnominal::sim::hidden
