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

TEST(Sampling, GivenAGapThenItsTimeIsSaid) {
  VectorXd t = VectorXd::LinSpaced(101, 0, 1);
  t.tail(50).array() += 0.2;
  Log log = log_of(t);
  EXPECT_THAT(message_of<InputError>([&] { make_even(log); }),
              testing::AllOf(HasSubstr("t = 0.5 s"), HasSubstr("a gap of 0.21 s")));
}

}  // namespace
