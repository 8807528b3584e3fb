#include "paper/experiment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "desk/paper/quick_arm.hpp"

namespace offnominal::desk::paper {
namespace {

using sim::FaultKind;
using test::kPaperTickS;
using test::quick_arm;

ExperimentResult run(FaultKind fault, Precision precision, bool accommodate = false,
                     const RobotDescription& robot = quick_arm()) {
  Experiment experiment;
  experiment.fault.kind = fault;
  experiment.precision = precision;
  experiment.accommodate = accommodate;
  experiment.record = true;
  return run_experiment(robot, experiment);
}

class PaperExperiment : public testing::TestWithParam<Precision> {};

TEST_P(PaperExperiment, WithoutFaultThereIsNoAlarmAndTheNetworkIsSilent) {
  const ExperimentResult healthy = run(FaultKind::kNone, GetParam());
  EXPECT_FALSE(healthy.detection_time_s);
  EXPECT_FALSE(healthy.fault_time_s);
  EXPECT_FALSE(healthy.fault_estimate_relative_error);
  EXPECT_EQ(healthy.max_abs_psi_hat_before_fault, 0.0);
  EXPECT_LT(healthy.max_error_to_threshold_before_fault, 1.0);
  EXPECT_GT(healthy.max_error_to_threshold_before_fault, 0.8) << "the uncertainty must be felt";
  EXPECT_EQ(healthy.steps, std::lround(20 / kPaperTickS));
}

TEST_P(PaperExperiment, MassLossIsDetectedWhenThePaperDoes) {
  const ExperimentResult result = run(FaultKind::kMassLoss, GetParam());
  ASSERT_TRUE(result.detection_time_s);
  EXPECT_NEAR(*result.detection_time_s, 10.6, 0.1);
  EXPECT_EQ(result.max_abs_psi_hat_before_fault, 0.0);
  EXPECT_LT(result.max_error_to_threshold_before_fault, 1.0);
  EXPECT_LE(result.max_weight_norm, 10.0);
  EXPECT_GT(result.max_weight_norm, 2.0) << "the network must have learnt";
}

TEST_P(PaperExperiment, NonlinearFaultIsDetectedWhenThePaperDoes) {
  const ExperimentResult result = run(FaultKind::kNonlinear, GetParam());
  ASSERT_TRUE(result.detection_time_s);
  EXPECT_NEAR(*result.detection_time_s, 11.0, 0.2);
  EXPECT_EQ(result.max_abs_psi_hat_before_fault, 0.0);
  EXPECT_LT(result.max_error_to_threshold_before_fault, 1.0);
  EXPECT_LE(result.max_weight_norm, 10.0);
}

TEST_P(PaperExperiment, NetworkIsSilentUntilTheDetectionItself) {
  const ExperimentResult result = run(FaultKind::kMassLoss, GetParam());
  ASSERT_TRUE(result.detection_time_s);
  for (std::size_t k = 0; k < result.series.time_s.size(); ++k) {
    if (result.series.time_s[k] >= *result.detection_time_s) break;
    ASSERT_EQ(result.series.psi_hat[0][k], 0.0) << result.series.time_s[k];
    ASSERT_EQ(result.series.psi_hat[1][k], 0.0) << result.series.time_s[k];
  }
}

TEST_P(PaperExperiment, AccommodationAtLeastHalvesTheTrackingError) {
  for (const FaultKind fault : {FaultKind::kMassLoss, FaultKind::kNonlinear}) {
    const double without = run(fault, GetParam(), false).tracking_rms_rad;
    const double with = run(fault, GetParam(), true).tracking_rms_rad;
    EXPECT_LE(with, 0.5 * without) << name_of(fault);
  }
}

// Theorem 4.2: once |eta| > 2 mu the fault must have been seen.
TEST_P(PaperExperiment, DetectionComesNoLaterThanGuaranteed) {
  for (const FaultKind fault : {FaultKind::kMassLoss, FaultKind::kNonlinear}) {
    const ExperimentResult result = run(fault, GetParam());
    ASSERT_TRUE(result.guaranteed_time_s) << name_of(fault);
    EXPECT_LE(*result.detection_time_s, *result.guaranteed_time_s) << name_of(fault);
  }
}

TEST_P(PaperExperiment, EstimateFollowsTheFault) {
  // The dead-zone stops learning while |e| <= mu, so that psi_hat stays within alpha mu of the
  // fault's trend; two-sided, so that a change of the estimator shows.
  const double mass = *run(FaultKind::kMassLoss, GetParam()).fault_estimate_relative_error;
  EXPECT_GT(mass, 0.15);
  EXPECT_LT(mass, 0.30);
  const double nonlinear = *run(FaultKind::kNonlinear, GetParam()).fault_estimate_relative_error;
  EXPECT_GT(nonlinear, 0.25);
  EXPECT_LT(nonlinear, 0.40);
}

TEST_P(PaperExperiment, DiscontinuousDeadZoneDetectsAtTheSameTickAndEstimatesCloser) {
  RobotDescription robot = quick_arm();
  robot.estimator.dead_zone = DeadZone::kDiscontinuous;
  for (const FaultKind fault : {FaultKind::kMassLoss, FaultKind::kNonlinear}) {
    const ExperimentResult continuous = run(fault, GetParam());
    const ExperimentResult discontinuous = run(fault, GetParam(), false, robot);
    EXPECT_EQ(continuous.detection_time_s, discontinuous.detection_time_s) << name_of(fault);
    EXPECT_LT(*discontinuous.fault_estimate_relative_error,
              *continuous.fault_estimate_relative_error)
        << name_of(fault);
  }
}

INSTANTIATE_TEST_SUITE_P(Scalars, PaperExperiment,
                         testing::Values(Precision::kFloat, Precision::kDouble),
                         [](const auto& parameter) { return name_of(parameter.param); });

TEST(PaperExperiment, FloatAgreesWithDouble) {
  for (const FaultKind fault : {FaultKind::kMassLoss, FaultKind::kNonlinear}) {
    for (const bool accommodate : {false, true}) {
      const ExperimentResult f = run(fault, Precision::kFloat, accommodate);
      const ExperimentResult d = run(fault, Precision::kDouble, accommodate);
      EXPECT_NEAR(*f.detection_time_s, *d.detection_time_s, 2.5 * kPaperTickS) << name_of(fault);
      double difference = 0.0, size = 0.0;
      for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t k = 0; k < d.series.time_s.size(); ++k) {
          difference += std::pow(f.series.psi_hat[i][k] - d.series.psi_hat[i][k], 2);
          size += std::pow(d.series.psi_hat[i][k], 2);
        }
      }
      ASSERT_GT(size, 0.0);
      EXPECT_LT(std::sqrt(difference / size), 0.01) << name_of(fault) << ' ' << accommodate;
    }
  }
}

TEST(PaperExperiment, DetectionDoesNotDependOnTheSeed) {
  RobotDescription robot = quick_arm();
  const double reference = *run(FaultKind::kMassLoss, Precision::kFloat).detection_time_s;
  for (const std::uint32_t seed : {2U, 77U, 4294967295U}) {
    robot.estimator.seed = seed;
    const ExperimentResult other = run(FaultKind::kMassLoss, Precision::kFloat, false, robot);
    EXPECT_EQ(*other.detection_time_s, reference) << seed;
    EXPECT_EQ(other.seed, seed);
    EXPECT_LT(*other.fault_estimate_relative_error, 0.30) << seed;
  }
}

TEST(PaperExperiment, SameSettingsGiveTheSameNumbers) {
  const ExperimentResult first = run(FaultKind::kNonlinear, Precision::kFloat, true);
  const ExperimentResult second = run(FaultKind::kNonlinear, Precision::kFloat, true);
  EXPECT_EQ(first.series.psi_hat[0], second.series.psi_hat[0]);
  EXPECT_EQ(first.tracking_rms_rad, second.tracking_rms_rad);
}

TEST(PaperExperiment, EveryNumberOfHiddenUnitsDetectsAlike) {
  RobotDescription robot = quick_arm();
  for (const int hidden : {1, 34, 35, 36, 64, 128}) {
    robot.estimator.hidden_units = hidden;
    const ExperimentResult result = run(FaultKind::kMassLoss, Precision::kFloat, false, robot);
    ASSERT_TRUE(result.detection_time_s) << hidden;
    EXPECT_NEAR(*result.detection_time_s, 10.575, 1.5 * kPaperTickS) << hidden;
    EXPECT_LE(result.max_weight_norm, 10.0) << hidden;
  }
}

TEST(PaperExperiment, AbruptFaultIsSeenSoonerThanAnIncipientOne) {
  Experiment experiment;
  experiment.fault.kind = FaultKind::kNonlinear;
  const double incipient = *run_experiment(quick_arm(), experiment).detection_time_s;
  experiment.fault.rate_per_s = sim::kAbrupt;
  const double abrupt = *run_experiment(quick_arm(), experiment).detection_time_s;
  EXPECT_GT(abrupt, 10.0);
  EXPECT_LT(abrupt, incipient);
}

TEST(PaperExperiment, TimeSeriesAreKeptOnlyWhenAskedFor) {
  const ExperimentResult kept = run(FaultKind::kNone, Precision::kFloat);
  const auto ticks = static_cast<std::size_t>(std::lround(20 / kPaperTickS));
  EXPECT_EQ(kept.series.time_s.size(), ticks);
  EXPECT_EQ(kept.series.q[1].size(), ticks);
  EXPECT_EQ(kept.series.threshold.size(), ticks);
  EXPECT_NEAR(kept.series.time_s.back(), 20.0, 1e-9);
  EXPECT_TRUE(run_experiment(quick_arm(), {}).series.time_s.empty());
}

TEST(PaperExperiment, RefusesWhatItCannotRun) {
  const auto refused = [](auto change) {
    RobotDescription robot = quick_arm();
    Experiment experiment;
    experiment.fault.kind = FaultKind::kMassLoss;
    change(robot, experiment);
    EXPECT_THROW(static_cast<void>(run_experiment(robot, experiment)), InputError);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([](auto& robot, auto&) { robot.joints.pop_back(); });
  refused([](auto& robot, auto&) { robot.bound.reset(); });
  refused([](auto& robot, auto&) { robot.estimator.space = EstimatorSpace::kTorque; });
  refused([](auto& robot, auto&) { robot.estimator.period_s = 0.0; });
  refused([](auto& robot, auto&) { robot.estimator.period_s = 0.1; });
  refused([nan](auto& robot, auto&) { robot.estimator.period_s = nan; });
  refused([](auto& robot, auto&) { robot.estimator.hidden_units = 0; });
  refused([](auto& robot, auto&) { robot.estimator.hidden_units = 257; });
  refused([](auto& robot, auto&) { robot.estimator.alpha = -1.0; });
  refused([](auto& robot, auto&) { robot.estimator.initial_weight_range = 100.0; });
  refused([](auto&, auto& experiment) { experiment.fault.mass_loss = 1.0; });
  refused([](auto&, auto& experiment) { experiment.fault.rate_per_s = 0.0; });
  refused([nan](auto&, auto& experiment) { experiment.duration_s = nan; });
  refused([](auto&, auto& experiment) { experiment.duration_s = 0.0; });
  // The fault would begin as the run ends.
  refused([](auto&, auto& experiment) { experiment.duration_s = 10.0; });
}

TEST(PaperExperiment, ArmThatLeavesItsRangeIsReportedAsSuch) {
  RobotDescription robot = quick_arm();
  for (RobotJoint& joint : robot.joints) joint.joint.max_velocity = 0.5;
  try {
    static_cast<void>(run_experiment(robot, {}));
    FAIL() << "the desired motion is faster than the limit";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("VelocityOutOfRange"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace offnominal::desk::paper
