#include "motion/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/plan_space.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// The family of motions, before any limit.

namespace offnominal::desk::motion {
namespace {

using Eigen::Index;

constexpr double kRateHz = 500;

Motion drawn_motion(std::uint64_t seed, double duration_s) {
  const PlanSpace space(2, duration_s);
  const MotionPlan plan = space.plan_at(space.random_point(seed));
  const PlanParts parts = parts_of(plan, {1.5, 0.2}, duration_s, kRateHz);
  return combined(parts, {{0.4, 0.3, 1}, {-0.1, 0.02, 0.5}});
}

class DrawnMotion : public ::testing::TestWithParam<double> {};

TEST_P(DrawnMotion, StartsAndEndsAtRestAtTheSamePlace) {
  const std::uint64_t seed = test::test_seed();
  SCOPED_TRACE(seed);
  for (int i = 0; i < test::repetitions(20); ++i) {
    const Motion motion = drawn_motion(seed + static_cast<std::uint64_t>(i), GetParam());
    for (const Index row : {Index{0}, motion.sample_count() - 1}) {
      EXPECT_NEAR(motion.q(row, 0), 0.4, 1e-12);
      EXPECT_NEAR(motion.q(row, 1), -0.1, 1e-12);
      EXPECT_NEAR(motion.dq.row(row).cwiseAbs().maxCoeff(), 0, 1e-9);
      EXPECT_NEAR(motion.ddq.row(row).cwiseAbs().maxCoeff(), 0, 1e-9);
    }
    EXPECT_GT(motion.dq.cwiseAbs().maxCoeff(), 0.01);
  }
}

// Central differences of what is smooth are right to the second order of the step; where only the
// third derivative jumps, to the first.
TEST_P(DrawnMotion, HasVelocitiesAndAccelerationsThatAreItsDerivatives) {
  const std::uint64_t seed = test::test_seed();
  SCOPED_TRACE(seed);
  for (int i = 0; i < test::repetitions(20); ++i) {
    const Motion motion = drawn_motion(seed + static_cast<std::uint64_t>(i), GetParam());
    const Index n = motion.sample_count();
    const Eigen::MatrixXd dq =
        (motion.q.bottomRows(n - 2) - motion.q.topRows(n - 2)) * (kRateHz / 2);
    const Eigen::MatrixXd ddq =
        (motion.dq.bottomRows(n - 2) - motion.dq.topRows(n - 2)) * (kRateHz / 2);
    const double fastest = motion.dq.cwiseAbs().maxCoeff();
    const double hardest = motion.ddq.cwiseAbs().maxCoeff();
    EXPECT_LT((dq - motion.dq.middleRows(1, n - 2)).cwiseAbs().maxCoeff(), 0.004 * fastest);
    EXPECT_LT((ddq - motion.ddq.middleRows(1, n - 2)).cwiseAbs().maxCoeff(), 0.04 * hardest);
  }
}

INSTANTIATE_TEST_SUITE_P(Durations, DrawnMotion, ::testing::Values(8.0, 30.0, 75.5));

TEST(DrawnMotion, DoesNotDependOnTheRateItIsSampledAt) {
  const PlanSpace space(1, 20);
  const MotionPlan plan = space.plan_at(space.random_point(3));
  const Motion coarse = combined(parts_of(plan, {1}, 20, 100), {{0, 1, 1}});
  const Motion fine = combined(parts_of(plan, {1}, 20, 1000), {{0, 1, 1}});
  for (Index i = 0; i < coarse.sample_count(); ++i) {
    EXPECT_NEAR(coarse.q(i, 0), fine.q(10 * i, 0), 1e-9);
  }
}

}  // namespace
}  // namespace offnominal::desk::motion
