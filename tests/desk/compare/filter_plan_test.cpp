#include "compare/filter_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "common/error.hpp"
#include "compare/motion.hpp"
#include "recorded_arm.hpp"

namespace {

using Eigen::VectorXd;
using offnominal::desk::filtered;
using offnominal::desk::FilterPlan;
using offnominal::desk::InputError;
using offnominal::desk::kept_samples;
using offnominal::desk::Log;
using offnominal::desk::motion_of;
using offnominal::desk::plan_filter;
using offnominal::test::arm_description;
using offnominal::test::arm_motion;
using offnominal::test::record_arm;

Log log_at(double rate_hz, double duration_s = 10) {
  return record_arm({.duration_s = duration_s, .rate_hz = rate_hz});
}

TEST(FilterPlan, DefaultsFollowTheMotionAndTheSamplingRate) {
  const FilterPlan fast = plan_filter({log_at(1000)}, arm_description(), {});
  EXPECT_DOUBLE_EQ(fast.torque_cutoff_hz, 12);
  EXPECT_DOUBLE_EQ(fast.position_cutoff_hz, 30);
  EXPECT_EQ(fast.decimation, 33);
  EXPECT_EQ(fast.edge_samples, 167);
  const FilterPlan slow = plan_filter({log_at(50)}, arm_description(), {});
  EXPECT_DOUBLE_EQ(slow.torque_cutoff_hz, 10);
  EXPECT_DOUBLE_EQ(slow.position_cutoff_hz, 22.5);
  EXPECT_EQ(slow.decimation, 2);
}

// What an encoder's step makes of the acceleration is kept small, but no arm's motion is cut off.
TEST(FilterPlan, ACoarseEncoderAsksForALowerCutOff) {
  offnominal::desk::RobotDescription coarse = arm_description();
  for (auto& joint : coarse.joints) joint.encoder.counts_per_unit = 4096 / (2 * std::numbers::pi);
  const FilterPlan plan = plan_filter({log_at(1000)}, coarse, {});
  EXPECT_LT(plan.torque_cutoff_hz, 12);
  EXPECT_GE(plan.torque_cutoff_hz, 8);
}

TEST(FilterPlan, ARecordingAtAnotherRateGetsTheSameFilter) {
  const FilterPlan plan = plan_filter({log_at(1000)}, arm_description(), {});
  const FilterPlan slower = offnominal::desk::plan_for(log_at(200), plan);
  EXPECT_DOUBLE_EQ(slower.torque_cutoff_hz, plan.torque_cutoff_hz);
  EXPECT_DOUBLE_EQ(slower.position_cutoff_hz, plan.position_cutoff_hz);
  EXPECT_EQ(slower.decimation, 6);
  EXPECT_NEAR(slower.period_s(), plan.period_s(), 0.1 * plan.period_s());
}

TEST(FilterPlan, OfARecordingIsTheSameWhicheverOthersComeFirst) {
  const Log fast = log_at(1000);
  const Log slow = log_at(60);
  for (const offnominal::desk::FilterRequest& request :
       {offnominal::desk::FilterRequest{},
        offnominal::desk::FilterRequest{.cutoff_hz = 20, .decimate = {}}}) {
    const FilterPlan after = plan_for(slow, plan_filter({fast, slow}, arm_description(), request));
    const FilterPlan first = plan_filter({slow, fast}, arm_description(), request);
    EXPECT_EQ(after.decimation, first.decimation);
    EXPECT_EQ(after.edge_samples, first.edge_samples);
    EXPECT_DOUBLE_EQ(after.torque_cutoff_hz, first.torque_cutoff_hz);
    EXPECT_DOUBLE_EQ(after.position_cutoff_hz, first.position_cutoff_hz);
  }
}

TEST(FilterPlan, RequestIsTakenOrRefusedWithWords) {
  const FilterPlan plan =
      plan_filter({log_at(1000)}, arm_description(), {.cutoff_hz = 20, .decimate = 5});
  EXPECT_DOUBLE_EQ(plan.position_cutoff_hz, 20);
  EXPECT_DOUBLE_EQ(plan.torque_cutoff_hz, 20);
  EXPECT_EQ(plan.decimation, 5);
  EXPECT_THROW(plan_filter({log_at(1000)}, arm_description(), {.cutoff_hz = 500, .decimate = {}}),
               InputError);
  EXPECT_THROW(plan_filter({log_at(1000)}, arm_description(), {.cutoff_hz = 0, .decimate = {}}),
               InputError);
  EXPECT_THROW(
      plan_filter({log_at(1000)}, arm_description(), {.cutoff_hz = std::nan(""), .decimate = {}}),
      InputError);
  EXPECT_THROW(plan_filter({log_at(1000)}, arm_description(), {.cutoff_hz = {}, .decimate = 0}),
               InputError);
}

TEST(FilterPlan, RecordingThatIsTooShortIsRefused) {
  EXPECT_NO_THROW(plan_filter({log_at(1000, 1.1)}, arm_description(), {}));
  EXPECT_THROW(plan_filter({log_at(1000, 0.9)}, arm_description(), {}), InputError);
}

// Whatever asks for too much of a recording is what is to be mended.
TEST(FilterPlan, TheOptionThatAsksForTooMuchIsNamed) {
  const auto refusal = [](const offnominal::desk::FilterRequest& request) {
    try {
      plan_filter({log_at(1000)}, arm_description(), request);
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
  const FilterPlan plan = plan_filter({log}, arm_description(), {});
  const VectorXd slow = (2 * std::numbers::pi * 0.5 * log.t_s).array().sin();
  const VectorXd kept = kept_samples(plan, slow);
  const VectorXd smooth = filtered(plan, slow);
  ASSERT_EQ(kept.size(), smooth.size());
  EXPECT_LT((kept - smooth).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_DOUBLE_EQ(kept_samples(plan, log.t_s)[0], 0.167);
  EXPECT_DOUBLE_EQ(kept_samples(plan, log.t_s)[1], 0.2);
}

TEST(Motion, DerivativesAreThoseOfTheRecordedMotion) {
  const Log log = log_at(1000);
  const FilterPlan plan = plan_filter({log}, arm_description(), {});
  const auto motion = motion_of(log, plan);
  for (const Eigen::Index i : {500, 5000, 9000}) {
    const auto exact = arm_motion(log.t_s[i], 1);
    EXPECT_NEAR(motion.q(i, 0), exact.q[0], 1e-6);
    EXPECT_NEAR(motion.dq(i, 1), exact.dq[1], 1e-4);
    EXPECT_NEAR(motion.ddq(i, 1), exact.ddq[1], 2e-3);
  }
}

}  // namespace
