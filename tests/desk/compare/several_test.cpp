#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/error.hpp"
#include "compare/compare.hpp"
#include "compare/compare_report.hpp"
#include "recorded_arm.hpp"

// Several recordings, and what the robot carries in each.

namespace offnominal::desk {
namespace {

using Eigen::Vector2d;
using test::arm_description;
using test::ArmInstant;
using test::record_arm;
using testing::HasSubstr;
using testing::SizeIs;

// A friction experiment: one recording per speed.
Log at_speed(double amplitude, double viscous, const std::string& file) {
  Log log = record_arm({.duration_s = 12, .rate_hz = 250, .amplitude = amplitude},
                       [&](const ArmInstant& at) { return Vector2d(0, viscous * at.dq[1]); });
  log.file = file;
  return log;
}

Comparisons compared(const std::vector<Log>& logs, const RobotDescription& robot) {
  const FilterPlan plan = plan_filter(logs, robot);
  std::vector<Comparison> all;
  for (const Log& log : logs) all.push_back(compare(robot, measure(log, robot, plan)));
  return together(std::move(all));
}

TEST(ComparedRecordings, HaveTheErrorOfAllTheirSamplesTogether) {
  const Comparisons all =
      compared({at_speed(1, 1, "fast.csv"), at_speed(0.3, 1, "slow.csv")}, arm_description());
  ASSERT_THAT(all.recordings, SizeIs(2));
  double error = 0;
  double torque = 0;
  for (const Comparison& one : all.recordings) {
    error += one.residual().col(1).squaredNorm();
    torque += one.measured.col(1).squaredNorm();
  }
  const double samples =
      static_cast<double>(all.recordings[0].t_s.size() + all.recordings[1].t_s.size());
  EXPECT_NEAR(all.joints[1].rms_error, std::sqrt(error / samples), 1e-12);
  EXPECT_NEAR(all.joints[1].relative_error_percent, 100 * std::sqrt(error / torque), 1e-9);
  EXPECT_EQ(all.joints[1].where.front().variable, "velocity") << "in one recording as in the other";
}

TEST(ComparedRecordings, GivenOneThenTheyAreThatOne) {
  const Comparisons all = compared({at_speed(1, 1, "a.csv")}, arm_description());
  EXPECT_EQ(all.joints[1].rms_error, all.recordings[0].joints[1].rms_error);
  EXPECT_THAT(all.joints[1].where, SizeIs(4)) << "there is nothing to differ from";
}

TEST(ComparedRecordings, GivenAnErrorThatIsOnesAloneThenItFollowsTheRecording) {
  const auto with_offset = [](double offset) {
    return record_arm({.duration_s = 12, .rate_hz = 250},
                      [=](const ArmInstant& /*at*/) { return Vector2d(0, offset); });
  };
  const Comparisons all = compared({with_offset(0), with_offset(2)}, arm_description());
  const auto& where = all.joints[1].where;
  const auto share_of = [&](const std::string& variable) {
    for (const ErrorShare& one : where) {
      if (one.variable == variable) return one.share;
    }
    return -1.0;
  };
  EXPECT_GT(share_of("recording"), 0.99);
  EXPECT_LT(share_of("velocity"), 0.2);
}

TEST(ComparedRecordings, AreListedOneByOneAndTogether) {
  const Comparisons all =
      compared({at_speed(1, 1, "fast.csv"), at_speed(0.3, 1, "slow.csv")}, arm_description());
  const CompareNames names{{"fast.csv", "slow.csv"}, "arm.toml", "offnominal compare"};
  const std::string text = text_of(all, names);
  for (const char* words : {"2 recordings against arm.toml", "recording 2: slow.csv", "all "}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
  const auto json = to_json(all, names);
  EXPECT_FALSE(json.contains("log")) << "there is no single one";
  ASSERT_THAT(json.at("recordings"), SizeIs(2));
  EXPECT_EQ(json.at("recordings")[1].at("log"), "slow.csv");
  EXPECT_EQ(json.at("recordings")[1].at("joints")[1].at("rms_error"),
            all.recordings[1].joints[1].rms_error);
  EXPECT_EQ(json.at("joints")[1].at("rms_error"), all.joints[1].rms_error);
  const report::Page page = page_of(all, names);
  std::vector<std::string> recordings;
  for (const report::Section& section : page.sections) recordings.push_back(section.recording);
  EXPECT_EQ(recordings,
            (std::vector<std::string>{"", "fast.csv", "fast.csv", "slow.csv", "slow.csv"}));
}

// The second link with 0.7 kg more at its end, 1 m from its joint.
Log with_payload() {
  test::ArmRecording settings{.duration_s = 12, .rate_hz = 250};
  settings.arm.mass2_kg += 0.7;
  Log log = record_arm(settings);
  log.file = "loaded.csv";
  return log;
}

TEST(ComparedRecordings, GivenAKnownPayloadThenTheModelCarriesItInThatRecordingAlone) {
  Log loaded = with_payload();
  const std::vector<Log> unsaid{record_arm({.duration_s = 12, .rate_hz = 250}), loaded};
  EXPECT_GT(compared(unsaid, arm_description()).recordings[1].joints[1].relative_error_percent, 10);
  const auto centre = arm_description().joints[1].joint.centre_of_mass_m;
  loaded.payload = Payload{0.7, centre};
  const Comparisons all = compared({unsaid[0], loaded}, arm_description());
  for (const Comparison& one : all.recordings) {
    EXPECT_LT(one.joints[0].relative_error_percent, 0.1);
    EXPECT_LT(one.joints[1].relative_error_percent, 0.1);
  }
  const auto json = to_json(all, {{"arm", "loaded.csv"}, "arm.toml", ""});
  EXPECT_TRUE(json.at("recordings")[0].at("payload").is_null());
  EXPECT_EQ(json.at("recordings")[1].at("payload").at("mass_kg"), 0.7);
}

TEST(ComparedRecordings, GivenOneOfAnotherRobotThenItIsNamed) {
  Log other = at_speed(1, 1, "other.csv");
  other.q.conservativeResize(Eigen::NoChange, 1);
  try {
    static_cast<void>(measure(other, arm_description(), FilterPlan{}));
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("other.csv: found 1 joints; allowed: 2"));
  }
}

}  // namespace
}  // namespace offnominal::desk
