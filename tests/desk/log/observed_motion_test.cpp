#include "log/observed_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

// Two joints of inertia 1, 0.5 and 2 s long, 19 bits, a torque that is no constant; velocities that
// are wrong.
Log positions_alone(Eigen::Index samples) {
  constexpr double kCount = 6.283185307179586 / (1 << 19);
  Log log;
  log.file = "two.csv";
  log.period_s = 0.001;
  log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, 0.001 * static_cast<double>(samples - 1));
  for (auto* columns : {&log.q, &log.dq, &log.tau}) columns->setZero(samples, 2);
  log.dq_derived = {true, false};
  for (Eigen::Index row = 0; row < samples; ++row) {
    const double t = log.t_s[row];
    log.q.row(row).setConstant(kCount * std::round(std::sin(3 * t) / kCount));
    log.tau.row(row).setConstant(-9 * std::sin(3 * t));
    log.dq.row(row).setConstant(99);
  }
  return log;
}

TEST(ObservedRecording, IsOneTimeOfPositionVelocityAndTorque) {
  const Log log = positions_alone(2000);
  const Log observed = as_observed(log);
  const Eigen::Index settled = MotionObserver(2, 0.001).ticks_to_settle();
  EXPECT_GT(settled, 40);
  ASSERT_EQ(observed.sample_count(), 2000 - settled);
  EXPECT_EQ(observed.t_s[0], log.t_s[settled]);
  EXPECT_EQ(observed.readings, log.q.bottomRows(2000 - settled));
  EXPECT_EQ(observed.dq_derived, std::vector<bool>(2, false));
  constexpr double kLateS = 0.0005 + 0.001 * 2 / (1.2214027581601699 - 1);  // 2 a / (1 - a) + 1/2
  for (Eigen::Index row = 200; row < observed.sample_count(); ++row) {
    const double t = observed.t_s[row] - kLateS;
    ASSERT_NEAR(observed.q(row, 0), std::sin(3 * t), 5e-4);
    ASSERT_NEAR(observed.dq(row, 1), 3 * std::cos(3 * t), 3e-3);
    ASSERT_NEAR(observed.tau(row, 1), -9 * std::sin(3 * t), 5e-3);
  }
  EXPECT_THAT(observed.remarks.back(), HasSubstr("200 rad/s"));
}

TEST(ObservedRecording, IsNoneOfOneThatEndsBeforeItHasSettled) {
  const Eigen::Index settled = MotionObserver(2, 0.001).ticks_to_settle();
  EXPECT_EQ(as_observed(positions_alone(settled + 1)).sample_count(), 1);
  try {
    static_cast<void>(as_observed(positions_alone(settled)));
    FAIL() << "nothing is left";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("two.csv"));
    EXPECT_THAT(error.what(), HasSubstr("more than"));
  }
}

}  // namespace
}  // namespace offnominal::desk
