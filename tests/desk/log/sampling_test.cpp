#include "log/sampling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"
#include "support/seed.hpp"

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::make_even;
using offnominal::test::message_of;
using ::testing::HasSubstr;

Log log_of(const VectorXd& t) {
  Log log;
  log.file = "log.csv";
  log.t_s = t;
  log.q = (3 * t).array().sin();
  log.dq = 3 * (3 * t).array().cos();
  log.tau = t;
  log.extra["temp1"] = 20 + t.array();
  log.dq_derived = {false};
  return log;
}

TEST(Sampling, SmallJitterIsEven) {
  VectorXd t = VectorXd::LinSpaced(101, 0, 1);
  t[50] += 0.00005;
  Log log = log_of(t);
  make_even(log);
  EXPECT_NEAR(log.period_s, 0.01, 1e-12);
  EXPECT_EQ(log.t_s, t);
  EXPECT_TRUE(log.remarks.empty());
}

TEST(Sampling, GivenUnevenStepsThenTheLogIsResampledAndSaysSo) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> step(0.008, 0.012);
  VectorXd t(400);
  t[0] = 2;
  for (Index i = 1; i < t.size(); ++i) t[i] = t[i - 1] + step(generator);
  Log log = log_of(t);
  make_even(log);
  ASSERT_EQ(log.remarks.size(), 1U);
  EXPECT_THAT(log.remarks[0], HasSubstr("not even"));
  EXPECT_GT(log.period_s, 0.008);
  EXPECT_LT(log.period_s, 0.012);
  EXPECT_EQ(log.t_s[0], 2);
  EXPECT_LE(log.t_s[log.sample_count() - 1], t[399]);
  EXPECT_GT(log.t_s[log.sample_count() - 1], t[399] - log.period_s);
  EXPECT_LT((log.q.col(0).array() - (3 * log.t_s).array().sin()).abs().maxCoeff(), 1e-4);
  EXPECT_LT((log.tau.col(0) - log.t_s).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((log.extra["temp1"].array() - 20 - log.t_s.array()).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(log.dq.rows(), log.sample_count());
}

// GIVEN rows that came at once, stamped 2 us apart WHEN resampled
// THEN the positions stay where they were recorded.
TEST(Sampling, GivenRowsThatCameAtOnceThenNothingSwings) {
  constexpr double kStepRad = 0.001;
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> late(0, 0.002);
  const VectorXd sampled = VectorXd::LinSpaced(1000, 0, 9.99);
  VectorXd t = sampled;
  for (double& stamp : t) stamp += late(generator);
  for (Index i = 50; i < t.size(); i += 100) t[i - 1] = t[i] - 2e-6;
  t[1] = t[0] + 2e-6;
  Log log = log_of(t);
  // As they were when they were sampled: the rows of a pair are 0.03 rad apart at most.
  log.q = ((3 * sampled).array().sin() / kStepRad).round() * kStepRad;
  make_even(log);
  ASSERT_EQ(log.remarks.size(), 1U);
  EXPECT_THAT(log.remarks[0], HasSubstr("not even"));
  // Stamps are up to 2 ms late at up to 3 rad/s, and of each pair one was sampled 10 ms before.
  EXPECT_LT((log.q.col(0).array() - (3 * log.t_s).array().sin()).abs().maxCoeff(), 0.03);
}

TEST(Sampling, GivenAGapThenItsSamplesAreMarked) {
  VectorXd t = VectorXd::LinSpaced(101, 0, 1);
  t.tail(50).array() += 0.2;
  Log log = log_of(t);
  make_even(log);
  EXPECT_EQ(log.sample_count(), 121);
  ASSERT_EQ(log.gaps.size(), 1U);
  EXPECT_NEAR(log.t_s[log.gaps[0].first], 0.51, 1e-9);
  EXPECT_NEAR(log.t_s[log.gaps[0].last], 0.69, 0.011);
  EXPECT_EQ(log.recorded_rows({0, 10}).last, 10);
  EXPECT_EQ(log.recorded_rows({120, 120}).last, 100);
  EXPECT_TRUE(log.cut.empty());
}

TEST(Sampling, GivenAFewLateStampsThenNothingIsMissing) {
  VectorXd t = VectorXd::LinSpaced(1001, 0, 1);
  for (const Eigen::Index row : {100, 500, 800}) t[row] += 0.0009;
  t[300] = t[301] - 1e-5;
  Log log = log_of(t);
  make_even(log);
  EXPECT_TRUE(log.gaps.empty());
}

TEST(Sampling, GivenAPauseThenTheLongestPartIsKept) {
  VectorXd t = VectorXd::LinSpaced(1001, 0, 10);
  t.tail(400).array() += 3600;
  Log log = log_of(t);
  make_even(log);
  EXPECT_EQ(log.sample_count(), 601);
  ASSERT_EQ(log.cut.size(), 1U);
  EXPECT_EQ(log.cut[0].first, 601);
  EXPECT_EQ(log.cut[0].last, 1000);
}

TEST(Sampling, GivenHardlyAnyRowsInALongTimeThenItIsRefused) {
  VectorXd t(2000);
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    const Eigen::Index burst = i / 100;
    t[i] = 1e-4 * static_cast<double>(i) + 9.0 * static_cast<double>(burst);
  }
  Log log = log_of(t);
  EXPECT_THAT(message_of<InputError>([&] { make_even(log); }), HasSubstr("a gap of 9 s"));
}

}  // namespace
