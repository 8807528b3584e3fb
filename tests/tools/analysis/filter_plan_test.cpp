#include "analysis/filter_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "analysis/motion.hpp"
#include "common/error.hpp"
#include "recorded_arm.hpp"

namespace {

using Eigen::VectorXd;
using offnominal::test::arm_motion;
using offnominal::test::record_arm;
using offnominal::tools::filtered;
using offnominal::tools::FilterPlan;
using offnominal::tools::InputError;
using offnominal::tools::kept_samples;
using offnominal::tools::Log;
using offnominal::tools::motion_of;
using offnominal::tools::plan_filter;

Log log_at(double rate_hz, double duration_s = 10) {
  return record_arm({.duration_s = duration_s, .rate_hz = rate_hz});
}

TEST(FilterPlan, DefaultsFollowTheSamplingRate) {
  const FilterPlan fast = plan_filter(log_at(1000), {});
  EXPECT_DOUBLE_EQ(fast.position_cutoff_hz, 100);
  EXPECT_DOUBLE_EQ(fast.torque_cutoff_hz, 40);
  EXPECT_EQ(fast.decimation, 10);
  EXPECT_EQ(fast.edge_samples, 50);
  const FilterPlan slow = plan_filter(log_at(200), {});
  EXPECT_DOUBLE_EQ(slow.position_cutoff_hz, 50);
  EXPECT_EQ(slow.decimation, 2);
  EXPECT_DOUBLE_EQ(slow.torque_cutoff_hz, 40);
  const FilterPlan slowest = plan_filter(log_at(50), {});
  EXPECT_DOUBLE_EQ(slowest.torque_cutoff_hz, 12.5);
  EXPECT_EQ(slowest.decimation, 1);
}

TEST(FilterPlan, RequestIsTakenOrRefusedWithWords) {
  const FilterPlan plan = plan_filter(log_at(1000), {.cutoff_hz = 20, .decimate = 5});
  EXPECT_DOUBLE_EQ(plan.position_cutoff_hz, 20);
  EXPECT_DOUBLE_EQ(plan.torque_cutoff_hz, 20);
  EXPECT_EQ(plan.decimation, 5);
  EXPECT_THROW(plan_filter(log_at(1000), {.cutoff_hz = 500, .decimate = {}}), InputError);
  EXPECT_THROW(plan_filter(log_at(1000), {.cutoff_hz = 0, .decimate = {}}), InputError);
  EXPECT_THROW(plan_filter(log_at(1000), {.cutoff_hz = std::nan(""), .decimate = {}}), InputError);
  EXPECT_THROW(plan_filter(log_at(1000), {.cutoff_hz = {}, .decimate = 0}), InputError);
}

TEST(FilterPlan, RecordingThatIsTooShortIsRefused) {
  EXPECT_NO_THROW(plan_filter(log_at(1000, 0.4), {}));
  EXPECT_THROW(plan_filter(log_at(1000, 0.25), {}), InputError);
}

// Whatever asks for too much of a recording is what is to be mended.
TEST(FilterPlan, TheOptionThatAsksForTooMuchIsNamed) {
  const auto refusal = [](const offnominal::tools::FilterRequest& request) {
    try {
      plan_filter(log_at(1000), request);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const double cutoff_hz : {1e-2, 1e-9, 1e-300}) {
    EXPECT_NE(refusal({.cutoff_hz = cutoff_hz, .decimate = {}}).find("larger --cutoff"),
              std::string::npos)
        << cutoff_hz;
  }
  EXPECT_NE(refusal({.cutoff_hz = {}, .decimate = 2'000'000'000}).find("smaller --decimate"),
            std::string::npos);
}

TEST(FilterPlan, FilteredSamplesStandWhereTheKeptOnesDo) {
  const Log log = log_at(1000);
  const FilterPlan plan = plan_filter(log, {});
  const VectorXd slow = (2 * std::numbers::pi * 0.5 * log.t_s).array().sin();
  const VectorXd kept = kept_samples(plan, slow);
  const VectorXd smooth = filtered(plan, slow);
  ASSERT_EQ(kept.size(), smooth.size());
  EXPECT_LT((kept - smooth).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_DOUBLE_EQ(kept_samples(plan, log.t_s)[0], 0.05);
  EXPECT_DOUBLE_EQ(kept_samples(plan, log.t_s)[1], 0.06);
}

TEST(Motion, DerivativesAreThoseOfTheRecordedMotion) {
  const Log log = log_at(1000);
  const FilterPlan plan = plan_filter(log, {});
  const auto motion = motion_of(log, plan);
  for (const Eigen::Index i : {500, 5000, 9000}) {
    const auto exact = arm_motion(log.t_s[i], 1);
    EXPECT_NEAR(motion.q(i, 0), exact.q[0], 1e-6);
    EXPECT_NEAR(motion.dq(i, 1), exact.dq[1], 1e-4);
    EXPECT_NEAR(motion.ddq(i, 1), exact.ddq[1], 2e-3);
  }
}

}  // namespace
