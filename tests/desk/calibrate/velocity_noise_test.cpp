#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_joints.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "log/part_of.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"

// An arm whose model is exact and whose velocity is noisy: all that is bounded is the velocity's
// own error, and the tightest bound of the model's is none.

namespace offnominal::desk {
namespace {

using ::testing::IsEmpty;

Log run_with_noisy_velocity(std::uint64_t seed) {
  Log log = test::record_arm({.duration_s = 30, .rate_hz = 500, .seed = seed});
  log.file = "run " + std::to_string(seed);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0, 1e-3);
  for (double& velocity : log.dq.reshaped()) velocity += noise(generator);
  return log;
}

RobotDescription written_and_read(const RobotDescription& robot) {
  return parse_robot(robot_text(robot), "r.toml");
}

TEST(CalibrateVelocityNoise, OfOneJointIsInItsBoundAndStartsNeedNoMore) {
  RobotDescription robot = test::arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  const JointsCalibration result =
      calibrate_joints(robot, {}, {run_with_noisy_velocity(1), run_with_noisy_velocity(2)},
                       {run_with_noisy_velocity(3)});
  EXPECT_THAT(result.objections, IsEmpty());
  const RobotDescription again = written_and_read(result.robot);
  EXPECT_TRUE(again.bound->covers_velocities);
  for (const std::size_t joint : {0U, 1U}) {
    EXPECT_EQ(again.bound->joints[joint].momentum_error, 0);
    for (const double value : again.bound->joints[joint].value) EXPECT_GT(value, 0);
    EXPECT_EQ(result.joints[joint].calibration.level.held_out_alarms, 0);
  }
  const Log other = run_with_noisy_velocity(4);
  for (Eigen::Index start = 0; start < other.sample_count() - 200; start += 613) {
    const Replay run = replay(again, part_of(other, {start, start + 199}));
    EXPECT_THAT(run.alarms, IsEmpty()) << start;
  }
}

// GIVEN one recording whose velocities somebody has made from its positions THEN the bound does not
// say that it holds what a controller's own are off by.
TEST(CalibrateVelocityNoise, OfVelocitiesThatNobodyMeasuredIsNotCovered) {
  RobotDescription robot = test::arm_description();
  Log derived = run_with_noisy_velocity(2);
  derived.dq_derived = {false, true};
  const Calibration paper =
      calibrate(robot, {}, {run_with_noisy_velocity(1), derived}, {run_with_noisy_velocity(3)});
  EXPECT_FALSE(paper.robot.bound->covers_velocities);
  robot.estimator.space = EstimatorSpace::kTorque;
  const JointsCalibration by_joint = calibrate_joints(
      robot, {}, {run_with_noisy_velocity(1), run_with_noisy_velocity(3)}, {derived});
  EXPECT_FALSE(by_joint.robot.bound->covers_velocities);
}

TEST(CalibrateVelocityNoise, AloneGivesAVelocityErrorAndABoundAboveZero) {
  const Calibration result = calibrate(test::arm_description(), {},
                                       {run_with_noisy_velocity(1), run_with_noisy_velocity(2)},
                                       {run_with_noisy_velocity(3)});
  EXPECT_THAT(result.objections, IsEmpty());
  EXPECT_GT(written_and_read(result.robot).bound->velocity_error, 0);
  EXPECT_EQ(result.level.held_out_alarms, 0);
}

// More than the recordings show: nothing is left for the bound.
TEST(CalibrateVelocityNoise, GivenAVelocityErrorAboveAllThenTheBoundIsStillAboveZero) {
  CalibrateRequest request;
  request.velocity_error = 1;
  const Calibration result = calibrate(test::arm_description(), request,
                                       {run_with_noisy_velocity(1), run_with_noisy_velocity(2)},
                                       {run_with_noisy_velocity(3)});
  EXPECT_EQ(written_and_read(result.robot).bound->velocity_error, 1);
}

}  // namespace
}  // namespace offnominal::desk
