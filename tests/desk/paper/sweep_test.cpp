#include "paper/sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/error.hpp"
#include "desk/paper/quick_arm.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk::paper {
namespace {

using test::quick_arm;

// Under the sanitizers every fifth step.
constexpr double kResolution = test::repetitions(20) == 20 ? 0.005 : 0.025;

std::optional<double> detection_of(double mass_loss, Precision precision) {
  Experiment experiment;
  experiment.fault.kind = sim::FaultKind::kMassLoss;
  experiment.fault.mass_loss = mass_loss;
  experiment.precision = precision;
  return run_experiment(quick_arm(), experiment).detection_time_s;
}

TEST(MassLossSweep, TenPercentIsDetectedAndSevenAndAHalfIsNot) {
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    EXPECT_TRUE(detection_of(0.10, precision)) << name_of(precision);
    EXPECT_FALSE(detection_of(0.075, precision)) << name_of(precision);
  }
}

TEST(MassLossSweep, LeavesNoStepOutUpToTwiceTheSmallestDetected) {
  std::size_t told = 0;
  const SweepResult sweep =
      sweep_mass_loss(quick_arm(), {}, kResolution, [&](const SweepProbe&) { ++told; });
  ASSERT_TRUE(sweep.smallest_detected);
  EXPECT_GT(*sweep.smallest_detected, 0.075);
  EXPECT_LE(*sweep.smallest_detected, 0.10 + 1e-9);
  EXPECT_EQ(told, sweep.probes.size());
  double last = 0.0;
  for (const SweepProbe& probe : sweep.probes) {
    EXPECT_GT(probe.mass_loss, last);
    if (probe.mass_loss <= 2.0 * *sweep.smallest_detected + 1e-9) {
      EXPECT_NEAR(probe.mass_loss - last, kResolution, 1e-9);
    }
    EXPECT_EQ(probe.detection_time_s.has_value(), probe.mass_loss >= *sweep.smallest_detected);
    last = probe.mass_loss;
  }
  EXPECT_NEAR(last, 0.95, 1e-9);
  ASSERT_TRUE(sweep.largest_undetected);
  EXPECT_NEAR(*sweep.largest_undetected, *sweep.smallest_detected - kResolution, 1e-9)
      << "no larger loss was missed";
}

TEST(MassLossSweep, NothingIsDetectedUnderAHugeBound) {
  RobotDescription robot = quick_arm();
  robot.bound->scaled_norm.scale = 1000.0;
  const SweepResult sweep = sweep_mass_loss(robot, {}, 0.1);
  EXPECT_FALSE(sweep.smallest_detected);
  EXPECT_NEAR(*sweep.largest_undetected, 0.95, 1e-9);
}

TEST(MassLossSweep, AnAlarmBeforeTheFaultDetectsNothing) {
  RobotDescription robot = quick_arm();
  robot.bound->scaled_norm.scale = 0.1;
  const SweepResult sweep = sweep_mass_loss(robot, {}, 0.1);
  ASSERT_TRUE(sweep.false_alarm_s);
  EXPECT_LT(*sweep.false_alarm_s, 10);
  EXPECT_FALSE(sweep.smallest_detected);
}

TEST(MassLossSweep, RefusesResolutionsOutOfRange) {
  for (const double resolution : {0.0, 0.2, -0.005, std::nan("")}) {
    EXPECT_THROW(static_cast<void>(sweep_mass_loss(quick_arm(), {}, resolution)), InputError);
  }
}

}  // namespace
}  // namespace offnominal::desk::paper
