// What the doctor leaves out of a recording, and what is made of the rest.
#include "explain/treatment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../../../bench/doctor/doctor_case.hpp"
#include "../compare/recorded_arm.hpp"
#include "common/error.hpp"
#include "compare/compare.hpp"
#include "compare/usable.hpp"
#include "explain/doctor.hpp"
#include "log/part_of.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

Log noisy_arm() {
  test::ArmRecording settings;
  settings.torque_noise = 0.05;
  return test::record_arm(settings);
}

std::string kinds_of(const std::vector<DataFault>& faults) {
  std::string kinds;
  for (const DataFault& fault : faults)
    kinds += std::string(kinds.empty() ? "" : " ") + name_of(fault.kind);
  return kinds;
}

bool is_left_out(const Log& log, Index joint, Index row) {
  return std::any_of(log.left_out.begin(), log.left_out.end(), [&](const LeftOut& out) {
    return out.joint == joint && out.rows.first <= row && row <= out.rows.last;
  });
}

// GIVEN a torque that is stuck from some row on WHEN the recording is treated THEN that joint is
// without those rows, the other one has all of its own, and compare says how many are left.
TEST(Treatment, LeavesOutATorqueThatIsStuckFromThenOnOfItsJointAlone) {
  Log log = noisy_arm();
  const RobotDescription robot = test::arm_description();
  const Comparison clean = compare(robot, measure(log, robot));
  const Index from = log.sample_count() / 2;
  log.tau.col(1).tail(log.sample_count() - from).setConstant(log.tau(from, 1));
  const auto faults = treat(log, robot);
  ASSERT_EQ(kinds_of(faults), "stuck");
  EXPECT_EQ(faults[0].joint, 1);
  ASSERT_EQ(faults[0].spans.size(), 1U);
  EXPECT_EQ(faults[0].spans[0].first_row, from + 2);
  EXPECT_EQ(faults[0].spans[0].last_row, log.sample_count());
  EXPECT_NEAR(faults[0].spans[0].from_s, log.t_s[from], 2 * log.period_s);
  EXPECT_EQ(faults[0].left_out_of, std::vector<Index>{1});
  EXPECT_FALSE(spoils(faults[0], RestsOn::kVelocityToo));
  EXPECT_TRUE(is_left_out(log, 1, from + 5));
  EXPECT_FALSE(is_left_out(log, 1, from - 5));
  EXPECT_FALSE(is_left_out(log, 0, from + 5));
  const Comparison left = compare(robot, measure(log, robot));
  EXPECT_EQ(left.joints[0].samples, clean.joints[0].samples);
  EXPECT_EQ(left.joints[0].rms_error, clean.joints[0].rms_error);
  EXPECT_GT(left.joints[1].at_fault, 0.4);
  EXPECT_LT(left.joints[1].samples, 0.6 * static_cast<double>(clean.joints[1].samples));
  EXPECT_NEAR(left.joints[1].relative_error_percent, clean.joints[1].relative_error_percent,
              0.5 * clean.joints[1].relative_error_percent);
}

// Of what the filter keeps nothing depends on what was left out.
TEST(Treatment, GivenOtherGarbageInAGapThenWhatIsLeftHardlyDiffers) {
  const RobotDescription robot = test::arm_description();
  std::vector<Comparison> results;
  for (const double garbage : {0.0, 5.0}) {
    Log log = noisy_arm();
    const Index from = log.sample_count() / 3;
    const Index count = 400;
    log.q.middleRows(from, count).array() += garbage;
    log.tau.middleRows(from, count).array() -= 10 * garbage;
    log.gaps.push_back({from, from + count - 1});
    // As the reader does: straight lines.
    for (Index joint = 0; joint < 2; ++joint) {
      DataFault fault;
      fault.kind = DataFaultKind::kStuck;
      fault.joint = joint;
      FaultSpan span;
      span.samples = {from, from + count - 1};
      fault.spans.push_back(span);
      for (const FaultySignal signal : {FaultySignal::kPosition, FaultySignal::kTorque}) {
        fault.signal = signal;
        bridge(fault, log);
      }
    }
    EXPECT_EQ(kinds_of(treat(log, robot)), "gaps");
    results.push_back(compare(robot, measure(log, robot)));
  }
  for (std::size_t joint = 0; joint < 2; ++joint) {
    EXPECT_EQ(results[0].joints[joint].rms_error, results[1].joints[joint].rms_error);
  }
}

TEST(Treatment, WhatTheUserKeepsIsNotLeftOut) {
  const RobotDescription robot = test::arm_description();
  for (const char* keep : {"1:saturation", "all:saturation"}) {
    Log log = noisy_arm();
    const double limit = 0.8 * log.tau.col(0).maxCoeff();
    log.tau.col(0) = log.tau.col(0).cwiseMin(limit);
    Log kept = log;
    const auto treated_faults = treat(log, robot);
    ASSERT_EQ(kinds_of(treated_faults), "saturation");
    EXPECT_FALSE(log.left_out.empty());
    const auto faults = treat(kept, robot, {keep_fault_of(keep)});
    ASSERT_EQ(kinds_of(faults), "saturation");
    EXPECT_TRUE(faults[0].overruled);
    EXPECT_TRUE(kept.left_out.empty());
  }
  Log log = noisy_arm();
  log.tau.col(1) *= -1;
  EXPECT_TRUE(spoils(treat(log, robot)[0], RestsOn::kTorque));
  EXPECT_FALSE(spoils(treat(log, robot, {keep_fault_of("2:torque_sign")})[0], RestsOn::kTorque));
  EXPECT_TRUE(spoils(treat(log, robot, {keep_fault_of("1:torque_sign")})[0], RestsOn::kTorque));
}

TEST(Treatment, SaysWhatMayBeKept) {
  for (const char* text :
       {"saturation", "0:gaps", "x:gaps", "1:saturatoin", "1:", ":gaps", "99999:gaps"}) {
    EXPECT_THROW(static_cast<void>(keep_fault_of(text)), InputError) << text;
  }
  try {
    static_cast<void>(keep_fault_of("1:saturatoin"));
  } catch (const InputError& error) {
    EXPECT_EQ(error.problem().mend, "write 1:saturation");
  }
}

TEST(Treatment, GivenNothingIsLeftThenItSaysSo) {
  const RobotDescription robot = test::arm_description();
  Log log = noisy_arm();
  for (Index joint = 0; joint < 2; ++joint) {
    log.tau.col(joint).tail(log.sample_count() - 200).setConstant(log.tau(199, joint));
  }
  const auto faults = treat(log, robot);
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults.back().kind, DataFaultKind::kNothingLeft);
  EXPECT_TRUE(spoils(faults.back(), RestsOn::kTorque));
  EXPECT_THROW(static_cast<void>(measure(log, robot)), InputError);
}

TEST(Treatment, GivenOneJointIsLostThenTheOtherIsCompared) {
  const RobotDescription robot = test::arm_description();
  Log log = noisy_arm();
  log.tau.col(1).tail(log.sample_count() - 200).setConstant(log.tau(199, 1));
  const auto faults = treat(log, robot);
  EXPECT_EQ(faults.back().kind, DataFaultKind::kNothingLeft);
  EXPECT_FALSE(spoils(faults.back(), RestsOn::kTorque));
  const Comparison left = compare(robot, measure(log, robot));
  EXPECT_GT(left.joints[0].samples, 100);
  EXPECT_EQ(left.joints[1].samples, 0);
  EXPECT_TRUE(std::isnan(left.joints[1].rms_error));
}

TEST(Treatment, PartsWithoutFaultsAreWhatIsBetweenThem) {
  Log log = noisy_arm();
  log.left_out = {{0, {1000, 1999}, 3}, {1, {1500, 2499}, 3}, {1, {2600, 2700}, 3}};
  const auto parts = untouched_parts(log, 0.5);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].sample_count(), 1000);
  EXPECT_EQ(parts[1].t_s[0], log.t_s[2701]);
  EXPECT_TRUE(parts[1].left_out.empty());
}

// A small share of `./dev bench doctor`, of both families: it is right about 98 to 99 % of
// thousands.
TEST(Treatment, IsRightAboutRecordingsOfSixJoints) {
  const std::uint64_t seed = test::test_seed();
  constexpr int kCases = 2 * test::repetitions(22);
  for (const auto family : {bench::Family::kDeveloped, bench::Family::kHeldOut}) {
    int wrong = 0;
    std::string which;
    for (int number = 0; number < kCases; ++number) {
      bench::DoctorCase made = bench::make_doctor_case(family, seed, number);
      const auto judgement = bench::judge(made, treat(made.log, made.robot));
      if (judgement.right) continue;
      ++wrong;
      which += std::to_string(number) + " " + std::string(name_of(made.truth.kind)) + ": " +
               judgement.said + "\n";
    }
    EXPECT_LE(wrong, kCases / 11) << which;
  }
}

}  // namespace
}  // namespace offnominal::desk
