#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "explain/doctor.hpp"
#include "serial_arm.hpp"

// Values that stay the same although the joint moves: of a dead encoder, and of a drive at its
// limit.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::optional<DataFault> fault_of(const Log& log, const RobotDescription& robot, Index joint,
                                  DataFaultKind kind) {
  for (DataFault& fault : examine(log, robot)) {
    if (fault.kind == kind && fault.joint == joint) return fault;
  }
  return std::nullopt;
}

constexpr Index kJoint = 1;

// From some time on one position, that the joint comes to as slowly as it would to rest.
Log with_frozen_position(Log log) {
  const VectorXd speed = log.dq.col(kJoint).cwiseAbs();
  Index row = log.sample_count() * 3 / 5;
  while (speed[row] > 0.02 * speed.maxCoeff()) ++row;
  log.q.col(kJoint).tail(log.sample_count() - row).setConstant(log.q(row, kJoint));
  log.dq_derived.assign(log.dq_derived.size(), true);
  return log;
}

TEST(StuckPosition, IsSeenByATorqueThatGoesOnToChange) {
  const RobotDescription robot = test::serial_arm(3);
  const Log log = with_frozen_position(test::record(robot, {.duration_s = 20}));
  const auto fault = fault_of(log, robot, kJoint, DataFaultKind::kStuck);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->signal, FaultySignal::kPosition);
  EXPECT_NEAR(fault->spans.at(0).to_s, 20, 0.1);
}

// The brake of a joint that rests takes its torque over at once, and gives it back at once.
TEST(StuckPosition, IsNoRestBehindABrake) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = with_frozen_position(test::record(robot, {.duration_s = 20}));
  Index row = log.sample_count() - 1;
  while (row > 0 && log.q(row - 1, kJoint) == log.q(row, kJoint)) --row;
  log.tau.col(kJoint).tail(log.sample_count() - row).setZero();
  EXPECT_FALSE(fault_of(log, robot, kJoint, DataFaultKind::kStuck));
}

// ... or, where that is read, by a velocity that goes to and fro all the while; the torque is next
// to nothing here.
TEST(StuckPosition, IsSeenByAVelocityThatGoesOn) {
  const RobotDescription robot = test::serial_arm(3);
  Log real = test::record(robot, {.duration_s = 20});
  real.tau *= 0.01;
  real.dq_derived.assign(real.dq_derived.size(), false);
  EXPECT_FALSE(fault_of(real, robot, kJoint, DataFaultKind::kStuck));
  Log log = with_frozen_position(real);
  log.dq_derived = real.dq_derived;
  EXPECT_TRUE(fault_of(log, robot, kJoint, DataFaultKind::kStuck));
}

// Zeros are what a bus or a drive that was lost leaves; one that is off gives none to a joint that
// rests.
TEST(StuckTorque, IsSeenAtZeroWhereTheMotionAsksForMore) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20});
  const Index rows = log.sample_count() / 4;
  log.tau.col(kJoint).tail(rows).setZero();
  const auto fault = fault_of(log, robot, kJoint, DataFaultKind::kStuck);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->signal, FaultySignal::kTorque);
  for (Index i = log.sample_count() - rows; i < log.sample_count(); ++i) {
    log.q.row(i) = log.q.row(log.sample_count() - rows - 1);
    log.dq.row(i).setZero();
  }
  for (const DataFault& one : examine(log, robot)) {
    EXPECT_FALSE(one.kind == DataFaultKind::kStuck && one.signal == FaultySignal::kTorque)
        << one.words;
  }
}

// A recording with the highest peak of a joint's torque cut down to what all else stays below; the
// first of those whose peak is wide enough.
Log with_a_peak_cut_off(const RobotDescription& robot) {
  constexpr Index kRows = 40;  // of half a peak, at most
  constexpr Index kCut = 15;
  test::SerialRecording settings{.duration_s = 9, .rate_hz = 100, .torque_noise_nm = 1e-6};
  for (;; ++settings.seed) {
    Log log = test::record(robot, settings);
    auto tau = log.tau.col(kJoint);
    Index peak = 0;
    tau.maxCoeff(&peak);
    double limit = 0;
    for (Index i = 0; i < tau.size(); ++i) {
      if (std::abs(i - peak) > kRows) limit = std::max(limit, 1.01 * tau[i]);
    }
    if ((tau.array() > limit).count() < kCut) continue;
    tau = tau.cwiseMin(limit).eval();
    return log;
  }
}

TEST(Saturation, IsSeenInOneStretchOfATorqueThatIsNotRounded) {
  const RobotDescription robot = test::serial_arm(2);
  const Log log = with_a_peak_cut_off(robot);
  const auto fault = fault_of(log, robot, kJoint, DataFaultKind::kSaturation);
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->spans.size(), 1U);
}

}  // namespace
}  // namespace offnominal::desk
