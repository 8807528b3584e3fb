// One start, brake or bump in one recording of many: covered by the bound, and not taken for a
// sample of how often the threshold is crossed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "calibrate/calibrate.hpp"
#include "calibrate/calibrate_report.hpp"
#include "desk/compare/recorded_arm.hpp"

namespace {

using Eigen::Vector2d;
using namespace offnominal::desk;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::record_arm;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Noise, and `bump` N m on joint 2 for 0.15 s from 12 s on.
Log bumped_recording(std::uint64_t seed, double bump = 0) {
  Log log = record_arm(
      {.duration_s = 30, .rate_hz = 200, .torque_noise = 0.5, .seed = seed},
      [&](const ArmInstant& at) { return Vector2d(0, at.t_s > 12 && at.t_s < 12.15 ? bump : 0); });
  log.file = "recording " + std::to_string(seed);
  return log;
}

RobotDescription arm_with_bound(double constant) {
  RobotDescription robot = arm_description();
  robot.bound.emplace().constant.value = constant;
  return robot;
}

Calibration calibrated(double bump, double old_bound = 50) {
  return calibrate(
      arm_with_bound(old_bound), {},
      {bumped_recording(1), bumped_recording(2, bump), bumped_recording(3), bumped_recording(4)},
      {bumped_recording(5)});
}

double constant_threshold(const Calibration& calibration) {
  return calibration.shapes.front().mean_threshold;
}

constexpr double kBump = 2.4;  // N m: about twice what noise alone asks for

TEST(CalibrateTransient, DoesNotDecideTheBound) {
  const Calibration quiet = calibrated(0);
  const Calibration bumped = calibrated(kBump);
  EXPECT_FALSE(quiet.transient);
  ASSERT_TRUE(bumped.transient);
  EXPECT_GT(bumped.transient->ratio, 1.2);
  EXPECT_LT(bumped.transient->ratio, 2.5) << "more would be refused as a fault";
  EXPECT_THAT(bumped.objections, IsEmpty());
  EXPECT_LT(constant_threshold(bumped), 2 * constant_threshold(quiet));
  EXPECT_GT(bumped.transient->mean_threshold_with, 2 * constant_threshold(bumped));
  // It is covered all the same: no recording raises an alarm.
  for (const JudgedStretch& stretch : bumped.stretches) {
    EXPECT_LE(stretch.max_ratio_after, 0.96) << stretch.file << ": a margin of 5 %";
  }
}

TEST(CalibrateTransient, IsListedWithRecordingTimeAndJoint) {
  const Calibration bumped = calibrated(kBump);
  ASSERT_TRUE(bumped.transient);
  EXPECT_EQ(bumped.transient->file, "recording 2");
  EXPECT_NEAR(bumped.transient->time_s, 12.1, 0.1);
  EXPECT_EQ(bumped.transient->joint, 1);
  EXPECT_THAT(bumped.notes, Contains(AllOf(HasSubstr("recording 2: one transient at 12."),
                                           HasSubstr("joint 2"))));
  const CalibrateNames names{"arm.toml", "new.toml", ""};
  EXPECT_EQ(to_json(bumped, names).at("transient").at("joint"), 2);
  EXPECT_TRUE(to_json(calibrated(0), names).at("transient").is_null());
}

TEST(CalibrateTransient, AFaultIsStillRefused) {
  const Calibration faulty = calibrated(4 * kBump);
  EXPECT_THAT(faulty.objections,
              Contains(AllOf(HasSubstr("recording 2: at 12."), HasSubstr("joint 2"))));
}

TEST(CalibrateMargin, AWidenedBoundIsNotWrittenWithoutAWord) {
  const Calibration wider = calibrated(0, 0.5);
  const BoundMargin margin = margin_of(wider);
  ASSERT_TRUE(margin.new_to_old);
  ASSERT_GT(*margin.new_to_old, 2);
  EXPECT_THAT(wider.notes, Contains(AllOf(HasSubstr("times as wide as the old one"),
                                          HasSubstr("|e| / mu of"), HasSubstr("block maxima"))));
  EXPECT_THAT(verdict_of(wider), HasSubstr("the recordings reach"));
  const CalibrateNames names{"arm.toml", "new.toml", ""};
  const nlohmann::ordered_json json = to_json(wider, names);
  EXPECT_EQ(json.at("new_to_old"), *margin.new_to_old);
  EXPECT_EQ(json.at("max_error_to_threshold_after"), margin.largest_ratio_after);
  EXPECT_EQ(page_of(wider, names).verdict.level, report::Level::kWarn);
  EXPECT_EQ(page_of(calibrated(0), names).verdict.level, report::Level::kGood);
}

}  // namespace
