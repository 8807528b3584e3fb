#include "calibrate/bound_shape.hpp"

#include <gtest/gtest.h>

#include <set>

#include "desk/compare/recorded_arm.hpp"
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
      const FilteredBasis basis = filtered_basis(robot, shape, recording);
      VectorXd all(shape.size + 1);
      all << c, velocity_error;
      const VectorXd threshold = basis.along * all;
      const VectorXd core = recorded_error(bounded, log).old_threshold;
      const Eigen::Index rows = core.size() - 1;
      EXPECT_LT((threshold.tail(rows) - core.tail(rows)).cwiseAbs().maxCoeff(),
                1e-12 * core.maxCoeff())
          << shape.words;
    }
    EXPECT_EQ(kinds.size(), 3U);
  }
}

TEST(FilteredBasis, FirstTickIsThatOfAMonitorThatStartsThere) {
  const Log log = noisy_recording();
  RobotDescription robot = watched_arm();
  robot.bound->velocity_error = 0.01;
  const RecordedError recording = recorded_error(robot, log);
  BoundShape shape;
  shape.settings = *robot.bound;
  shape.size = 2;
  const FilteredBasis basis = filtered_basis(robot, shape, recording);
  for (const Eigen::Index start : {0, 17, 1500}) {
    Log late = log;
    late.t_s = log.t_s.segment(start, 20).eval();
    late.q = log.q.middleRows(start, 20).eval();
    late.dq = log.dq.middleRows(start, 20).eval();
    late.tau = log.tau.middleRows(start, 20).eval();
    const Replay monitor = replay(robot, late);
    EXPECT_NEAR(recording.first_tick[start + 1], monitor.error_norm[1], 1e-12);
    const Eigen::Vector3d all(1, 1, 0.01);
    EXPECT_NEAR(basis.first_tick.row(start + 1) * all, monitor.threshold[1], 1e-12);
  }
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
