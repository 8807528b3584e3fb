#include "offnominal/sim/trajectory.hpp"

#include <gtest/gtest.h>

namespace offnominal::sim {
namespace {

TEST(PaperTrajectory, DerivativesBelongToThePositions) {
  const double h = 1e-4;
  for (const double t : {0.0, 0.7, 3.1, 12.4}) {
    const DesiredMotion before = paper_trajectory(t - h), now = paper_trajectory(t),
                        after = paper_trajectory(t + h);
    EXPECT_LT(((after.q - before.q) / (2.0 * h) - now.dq).norm(), 1e-7) << t;
    EXPECT_LT(((after.dq - before.dq) / (2.0 * h) - now.ddq).norm(), 1e-7) << t;
  }
}

TEST(PaperTrajectory, StaysInThePaperDomain) {
  for (int k = 0; k <= 20000; ++k) {
    const DesiredMotion d = paper_trajectory(1e-3 * k);
    ASSERT_LE(std::abs(d.q[0]), 0.19);
    ASSERT_LE(std::abs(d.q[1]), 0.23);
    ASSERT_LE(std::abs(d.dq[0]), 0.36 + 1e-12);
    ASSERT_LE(std::abs(d.dq[1]), 0.63 + 1e-12);
  }
}

}  // namespace
}  // namespace offnominal::sim
