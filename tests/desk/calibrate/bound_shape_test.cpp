#include "calibrate/bound_shape.hpp"

#include <gtest/gtest.h>

#include <set>

#include "calibrate/tightest.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "log/part_of.hpp"
#include "replay/replay.hpp"
#include "robot/monitor_config_of.hpp"

// What calibration computes by itself against what the core's monitor computes.

namespace {

using Eigen::VectorXd;
using namespace offnominal::desk;
using offnominal::test::arm_description;
using offnominal::test::record_arm;

RobotDescription watched_arm() {
  RobotDescription robot = arm_description();
  robot.bound = BoundSettings{};
  robot.bound->kind = BoundSettings::Kind::kScaledNorm;
  robot.bound->scaled_norm = {1, 1, {{2, -6}}};
  return robot;
}

Log noisy_recording() { return record_arm({.duration_s = 3, .torque_noise = 0.3}); }

TEST(FilteredBasis, OfEveryShapeGivesTheThresholdOfTheMonitor) {
  const Log log = noisy_recording();
  for (const auto signal : {offnominal::TorqueSignal::kSampled, offnominal::TorqueSignal::kHeld}) {
    RobotDescription robot = watched_arm();
    robot.estimator.torque_signal = signal;
    const RecordedError recording = recorded_error(robot, log);
    std::set<BoundSettings::Kind> kinds;
    for (const BoundShape& shape : bound_shapes(robot, {recording})) {
      kinds.insert(shape.settings.kind);
      VectorXd c = VectorXd::LinSpaced(shape.size, 0.5, 2);
      const double velocity_error = 0.0625;
      RobotDescription bounded = robot;
      bounded.bound = bound_with(shape, c, velocity_error);
      if (shape.settings.kind == BoundSettings::Kind::kTable) {
        for (Eigen::Index i = 0; i < c.size(); ++i) {
          c[i] = bounded.bound->table.value[static_cast<std::size_t>(i)];
        }
      }
      const VectorXd threshold =
          (filtered_basis(robot, shape, recording) * c).array() + 2 * velocity_error;
      const VectorXd core = recorded_error(bounded, log).old_threshold;
      const Eigen::Index rows = core.size() - 1;
      EXPECT_LT((threshold.tail(rows) - core.tail(rows)).cwiseAbs().maxCoeff(),
                1e-12 * core.maxCoeff())
          << shape.words;
    }
    EXPECT_EQ(kinds.size(), 3U);
  }
}

TEST(FilteredBasis, OfALaterStartIsThatOfAMonitorThatStartsThere) {
  const Log log = noisy_recording();
  RobotDescription robot = watched_arm();
  robot.bound->velocity_error = 0.01;
  const RecordedError recording = recorded_error(robot, log);
  BoundShape shape;
  shape.settings = *robot.bound;
  shape.size = 2;
  ThresholdRows rows;
  rows.filtered = filtered_basis(robot, shape, recording);
  rows.constant = 2;
  const Eigen::Vector3d c(1, 1, 0.01);
  const auto starts = starts_before(recording.filter());
  ASSERT_GT(starts.size(), 8U);
  ASSERT_EQ(starts.front().ticks, 1);
  EXPECT_LT(starts.back().kept, 0.05);
  for (const Eigen::Index from : {0, 17, 1500}) {
    const Replay monitor = replay(robot, part_of(log, {from, log.sample_count() - 1}));
    for (const StartBefore& start : starts) {
      const Eigen::Index at = from + start.ticks;
      if (at >= log.sample_count()) break;
      EXPECT_NEAR(recording.error_norm_after(start, at, at + 1)[0], monitor.error_norm[start.ticks],
                  1e-12);
      EXPECT_NEAR(rows.threshold(start, rows.along(c), c)[at], monitor.threshold[start.ticks],
                  1e-12);
    }
  }
  EXPECT_EQ(recording.error_norm_after(starts.back(), 0, 5), VectorXd::Zero(5))
      << "nothing was recorded so far back";
}

TEST(RecordedError, IsWhatReplayShowsBeforeAnyAlarm) {
  const Log log = noisy_recording();
  RobotDescription robot = watched_arm();
  robot.bound->scaled_norm.scale = 100;
  const Replay shown = replay(robot, log);
  ASSERT_FALSE(shown.detection_time_s);
  const RecordedError recording = recorded_error(robot, log);
  EXPECT_EQ(recording.error_norm, shown.error_norm);
  EXPECT_EQ(recording.old_threshold, shown.threshold);
  robot.bound.reset();
  EXPECT_EQ(recorded_error(robot, log).error_norm, shown.error_norm) << "no bound is needed";
}

TEST(BoundWith, RoundsUpAndNeverDown) {
  BoundShape shape;
  const auto value = [&](double c) {
    return bound_with(shape, VectorXd::Constant(1, c), 0).constant.value;
  };
  EXPECT_EQ(value(1.23451), 1.235);
  EXPECT_EQ(value(0.1), 0.1);
  EXPECT_EQ(value(99991), 1e5);
  for (double c = 1e-9; c < 1e9; c *= 1.37) {
    EXPECT_GE(value(c), c);
    EXPECT_LE(value(c), 1.0011 * c);
  }
}

}  // namespace
