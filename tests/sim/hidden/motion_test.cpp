#include "offnominal/sim/hidden/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "offnominal/sim/hidden/draw_robot.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Vector2d;

void expect_derivatives(const Motion& motion, double t_s) {
  const double h = 1e-5;
  const DesiredMotion before = motion(t_s - h), here = motion(t_s), after = motion(t_s + h);
  EXPECT_LT(((after.q - before.q) / (2.0 * h) - here.dq).norm(), 1e-6) << t_s;
  EXPECT_LT(((after.dq - before.dq) / (2.0 * h) - here.ddq).norm(), 1e-5) << t_s;
}

TEST(HiddenMotion, VelocityAndAccelerationAreDerivatives) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Draws draws(seed, Stream::kMotion);
    const Motion rich = rich_motion({0.3, -0.2}, draws);
    const Motion poor = poor_motion({0.3, -0.2}, draws);
    for (const double t_s : {0.1, 3.7, 21.3}) {
      expect_derivatives(rich, t_s);
      expect_derivatives(poor, t_s);
    }
  }
}

// Written down, as another compiler must draw the same: a speed and a range are two draws.
TEST(HiddenMotion, OfOneSpeedIsTheSameEverywhere) {
  Draws draws(2, Stream::kMotion);
  const DesiredMotion motion = poor_motion({0.3, -0.2}, draws)(3.7);
  EXPECT_NEAR(motion.q[0], 0.061440799149, 1e-11);
  EXPECT_NEAR(motion.dq[0], 0.317374398701, 1e-11);
}

TEST(HiddenMotion, RichMotionIsRich) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Request request{seed, {}};
    const DrawnRobot drawn = draw_robot(request);
    const Survey s = survey(drawn.robot, drawn_motion(request, drawn.centre_rad, Stream::kMotion));
    for (Eigen::Index j = 0; j < 2; ++j) {
      const NominalJoint& limits = drawn.nominal.joints[static_cast<std::size_t>(j)];
      EXPECT_GT(s.q.col(j).maxCoeff() - s.q.col(j).minCoeff(), 1.4) << seed;
      EXPECT_LT(s.q.col(j).maxCoeff(), limits.position_max_rad) << seed;
      EXPECT_GT(s.q.col(j).minCoeff(), limits.position_min_rad) << seed;
      EXPECT_GT(s.dq.col(j).cwiseAbs().maxCoeff(), 1.4) << seed;
      EXPECT_LT(s.dq.col(j).cwiseAbs().maxCoeff(), limits.velocity_limit_rad_s) << seed;
      EXPECT_GT((s.dq.col(j).array().abs() < 0.1).count(), s.dq.rows() / 20)
          << seed;  // slow phases
      int reversals = 0;
      for (Eigen::Index k = 1; k < s.dq.rows(); ++k) {
        if (s.dq(k, j) * s.dq(k - 1, j) < 0.0) ++reversals;
      }
      EXPECT_GT(reversals, 10) << seed;
      EXPECT_GT(s.tau.col(j).maxCoeff() * -s.tau.col(j).minCoeff(), 0.0) << seed;  // both signs
    }
  }
}

TEST(HiddenMotion, PoorMotionIsPoor) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Request request{seed, {}};
    request.excitation = Excitation::kPoor;
    const DrawnRobot drawn = draw_robot(request);
    const Survey s = survey(drawn.robot, drawn_motion(request, drawn.centre_rad, Stream::kMotion));
    EXPECT_LT(s.dq.cwiseAbs().maxCoeff(), 0.5) << seed;
    EXPECT_GT(s.dq.cwiseAbs().maxCoeff(), 0.05) << seed;
    for (Eigen::Index j = 0; j < 2; ++j) {
      EXPECT_LT(s.q.col(j).maxCoeff() - s.q.col(j).minCoeff(), 0.9) << seed;
    }
  }
}

TEST(HiddenMotion, SplineFollowsAGivenSine) {
  const Eigen::Index n = 301;
  Eigen::VectorXd t_s(n);
  Eigen::MatrixXd q(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    t_s[k] = 0.02 * static_cast<double>(k);
    q.row(k) << std::sin(2.0 * t_s[k]), 0.5 * std::cos(3.0 * t_s[k]);
  }
  const Motion motion = given_motion(t_s, q);
  EXPECT_LT((motion(t_s[17]).q - q.row(17).transpose()).norm(), 1e-14);
  for (const double t : {1.003, 2.5, 4.217}) {
    const DesiredMotion m = motion(t);
    EXPECT_NEAR(m.q[0], std::sin(2.0 * t), 1e-7);
    EXPECT_NEAR(m.dq[1], -1.5 * std::sin(3.0 * t), 1e-4);
    EXPECT_NEAR(m.ddq[0], -4.0 * std::sin(2.0 * t), 5e-3);
  }
  EXPECT_EQ(motion(100.0).q, Vector2d(q.row(n - 1)));
  EXPECT_EQ(motion(100.0).dq, Vector2d::Zero());
}

TEST(HiddenMotion, RefusesTimesAndPositionsThatAreNone) {
  const Eigen::MatrixXd q = Eigen::MatrixXd::Zero(3, 2);
  EXPECT_THROW(given_motion(Eigen::Vector3d(0.0, 1.0, 1.0), q), std::invalid_argument);
  EXPECT_THROW(given_motion(Eigen::Vector3d(0.0, 1.0, std::nan("")), q), std::invalid_argument);
  EXPECT_THROW(given_motion(Eigen::Vector3d(0.5, 1.0, 2.0), q), std::invalid_argument);
  EXPECT_THROW(given_motion(Eigen::Vector2d(0.0, 1.0), q), std::invalid_argument);
  EXPECT_THROW(given_motion(Eigen::Vector3d(0.0, 1.0, 2.0), Eigen::MatrixXd::Zero(3, 3)),
               std::invalid_argument);
}

}  // namespace
}  // namespace offnominal::sim::hidden
