#include "paper/recorded_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "paper/experiment.hpp"
#include "paper/two_link_robot.hpp"

namespace {

using offnominal::desk::InputError;
using offnominal::desk::paper::Experiment;
using offnominal::desk::paper::RecordedMotion;
using offnominal::sim::DesiredMotion;
using offnominal::test::put;
using offnominal::test::TemporaryFolder;
using ::testing::HasSubstr;

// q1 = 0.3 - 0.3 cos 2t, q2 = half of it, over one period: at rest at both ends.
std::string motion_csv(int rows) {
  std::string text = "t,q1,q2,dq1,dq2,ddq1,ddq2\n";
  for (int i = 0; i < rows; ++i) {
    const double t = std::numbers::pi * i / (rows - 1);
    const double q = 0.3 - 0.3 * std::cos(2 * t);
    const double dq = 0.6 * std::sin(2 * t);
    const double ddq = 1.2 * std::cos(2 * t);
    for (const double value : {5 + t, q, q / 2, dq, dq / 2, ddq}) {
      text += std::to_string(value) + ",";
    }
    text += std::to_string(ddq / 2) + "\n";
  }
  return text;
}

class Recorded : public ::testing::Test {
 protected:
  RecordedMotion read(const std::string& text) const {
    put(folder_ / "motion.csv", text);
    return RecordedMotion::read(folder_ / "motion.csv");
  }
  std::string refusal(const std::string& text) const {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(Recorded, MotionIsSmoothBetweenItsRows) {
  const RecordedMotion motion = read(motion_csv(200));
  EXPECT_NEAR(motion.duration_s(), 3.14159, 1e-4);
  for (double t = 0.05; t < 3.1; t += 0.0137) {
    const DesiredMotion at = motion.at(t);
    EXPECT_NEAR(at.q[0], 0.3 - 0.3 * std::cos(2 * t), 2e-6);
    EXPECT_NEAR(at.dq[1], 0.3 * std::sin(2 * t), 1e-3);
    EXPECT_NEAR(at.ddq[0], 1.2 * std::cos(2 * t), 1e-3);
  }
}

TEST_F(Recorded, MotionRestsBeforeAndAfter) {
  const RecordedMotion motion = read(motion_csv(50));
  for (const double t : {-1.0, 0.0, 3.2, 100.0}) {
    EXPECT_NEAR(motion.at(t).q[0], 0, 1e-5);
    EXPECT_EQ(motion.at(t).dq.norm(), 0);
    EXPECT_EQ(motion.at(t).ddq.norm(), 0);
  }
}

TEST_F(Recorded, WhatIsNoMotionIsRefused) {
  EXPECT_THAT(refusal("t,q1,dq1,ddq1\n0,1,2,3\n1,2,3,4\n"), HasSubstr("q2"));
  EXPECT_THAT(refusal("t,q1,q2,dq1,dq2,ddq1,ddq2\n0,0,0,0,0,0,0\n0,0,0,0,0,0,0\n"),
              HasSubstr("does not ascend"));
  EXPECT_THAT(refusal("t,q1,q2,dq1,dq2,ddq1,ddq2\n0,0,0,0,0,0,0\n"), HasSubstr("one row"));
}

// Its first joints would move as if they were those of this robot.
TEST_F(Recorded, MotionOfARobotWithMoreJointsIsRefused) {
  const std::string text =
      "t,q1,q2,q3,dq1,dq2,dq3,ddq1,ddq2,ddq3\n0,0,0,0,0,0,0,0,0,0\n1,0,0,0,0,0,0,0,0,0\n";
  EXPECT_THAT(refusal(text), ::testing::AllOf(HasSubstr("motion.csv"), HasSubstr("found q1 to q3"),
                                              HasSubstr("joints 1 to 2, and no more")));
}

TEST_F(Recorded, TheArmFollowsItInPlaceOfThePapersMotion) {
  Experiment experiment;
  experiment.fault.kind = offnominal::sim::FaultKind::kNone;
  experiment.motion = std::make_shared<RecordedMotion>(read(motion_csv(400)));
  experiment.duration_s = experiment.motion->duration_s();
  experiment.record = true;
  const auto run = offnominal::desk::paper::run_experiment(
      offnominal::desk::paper::two_link_robot(), experiment);
  double largest = 0;
  for (std::size_t i = 0; i < run.series.time_s.size(); ++i) {
    const DesiredMotion wanted = experiment.motion->at(run.series.time_s[i]);
    EXPECT_NEAR(run.series.q[0][i], wanted.q[0], 0.05);
    largest = std::max(largest, run.series.q[0][i]);
  }
  EXPECT_GT(largest, 0.5);
}

}  // namespace
