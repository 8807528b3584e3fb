// Pushes: the torque that a force on a link asks of the joints for a moment, in recordings of a
// robot that is otherwise as its file says, or lacks something.

#include "explain/pushes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kJoints = 4;
constexpr double kFromS = 8.73;
constexpr double kToS = 9.31;

ExplainOptions quick() {
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.replays = 0;
  options.threads = 2;
  return options;
}

Log recorded(const RobotDescription& robot, std::uint64_t seed = 1) {
  return test::record(robot, {.duration_s = 20, .seed = seed});
}

// Of a force on the third link: the drives of the joints before it give this much more, by where
// they stand.
void push(Log& log, double from_s, double to_s, double size_nm = 4) {
  for (Index i = 0; i < log.t_s.size(); ++i) {
    if (log.t_s[i] < from_s || log.t_s[i] >= to_s) continue;
    log.tau(i, 0) += size_nm * std::cos(log.q(i, 0));
    log.tau(i, 1) += 0.7 * size_nm * std::cos(log.q(i, 1));
    log.tau(i, 2) += 0.3 * size_nm;
  }
}

void expect_times(const Push& push, double from_s, double to_s) {
  constexpr double kToldS = 0.1;
  EXPECT_NEAR(push.from_s, from_s, kToldS);
  EXPECT_NEAR(push.to_s, to_s, kToldS);
}

TEST(Pushes, AreToldWithTheirTimesAndJointsAndLeaveTheRestAlone) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  push(log, kFromS, kToS);
  const Explanation told = explain(robot, {log}, {}, quick());
  ASSERT_THAT(told.pushes, SizeIs(1)) << told.words;
  expect_times(told.pushes[0], kFromS, kToS);
  EXPECT_THAT(told.pushes[0].joints, Contains(Field(&Push::OnJoint::joint, 2)));
  EXPECT_THAT(told.found, IsEmpty()) << told.words;
  EXPECT_EQ(told.verdict, Verdict::kUnknownExternal) << told.words;
  EXPECT_THAT(told.words, HasSubstr("pushes the arm from outside: 8."));
  // What is said of the model is said of the rest.
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.rms_after, 2 * joint.noise_floor) << joint.joint;
  }
}

TEST(Pushes, SeveralAreToldEach) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  push(log, 4.2, 4.6, 3);
  push(log, kFromS, kToS, 40);
  push(log, 14.9, 15.9, 5);
  const Explanation told = explain(robot, {log}, {}, quick());
  ASSERT_THAT(told.pushes, SizeIs(3)) << told.words;
  expect_times(told.pushes[0], 4.2, 4.6);
  expect_times(told.pushes[1], kFromS, kToS);
  expect_times(told.pushes[2], 14.9, 15.9);
  // Nothing of them is left in the rest, of the largest neither.
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.rms_after, 2 * joint.noise_floor) << joint.joint;
  }
}

// As large, but no push for where it is: the other is told all the same.
TEST(Pushes, AtAnEndHideNoOther) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  push(log, 0.1, 0.4);
  push(log, 4.2, 4.8);
  push(log, 19.3, 20);
  const Explanation told = explain(robot, {log}, {}, quick());
  ASSERT_THAT(told.pushes, SizeIs(1)) << told.words;
  expect_times(told.pushes[0], 4.2, 4.8);
}

TEST(Pushes, HideNothingThatIsMissingAllTheTime) {
  const RobotDescription robot = test::serial_arm(kJoints);
  RobotDescription file = robot;
  std::erase_if(file.effects, [](const RobotEffect& one) {
    return one.joint == 1 && one.kind == EffectKind::kCoulombFriction;
  });
  Log log = recorded(robot);
  push(log, kFromS, kToS, 30);
  const Explanation told = explain(file, {log}, {}, quick());
  ASSERT_THAT(told.pushes, SizeIs(1)) << told.words;
  expect_times(told.pushes[0], kFromS, kToS);
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kCoulombFriction, 1}));
  EXPECT_EQ(told.verdict, Verdict::kFound) << told.words;
}

TEST(Pushes, OfTheHeldOutRecordingAreLeftOutOfIt) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log held_out = recorded(robot, 2);
  held_out.file = "held out";
  push(held_out, 5, 5.5, 20);
  const Explanation told = explain(robot, {recorded(robot)}, {held_out}, quick());
  ASSERT_THAT(told.pushes, SizeIs(1)) << told.words;
  EXPECT_EQ(told.pushes[0].file, "held out");
  for (const JointErrors& joint : told.joints) {
    EXPECT_LT(joint.holdout_after, 2 * joint.holdout_noise_floor) << joint.joint;
  }
}

// A bump that the drive has wherever the joint passes one place.
TEST(Pushes, AreNoneWhatComesBackWithThePosition) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  for (Index i = 0; i < log.t_s.size(); ++i) {
    const double from = (log.q(i, 1) - 0.9 * log.q.col(1).maxCoeff()) / 0.05;
    log.tau(i, 1) += 3 * std::exp(-from * from);
  }
  EXPECT_THAT(explain(robot, {log}, {}, quick()).pushes, IsEmpty());
}

// What stays is a change, and what is missing all the time no event.
TEST(Pushes, AreNoneWhatStays) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log changed = recorded(robot);
  push(changed, 12, 20);
  EXPECT_THAT(explain(robot, {changed}, {}, quick()).pushes, IsEmpty());
  Log often = recorded(robot);
  for (int i = 0; i < 9; ++i) push(often, 1 + 2.0 * i, 1.7 + 2.0 * i);
  EXPECT_THAT(explain(robot, {often}, {}, quick()).pushes, IsEmpty());
}

TEST(Pushes, StandInJson) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  push(log, kFromS, kToS);
  const auto json = to_json(explain(robot, {log}, {}, quick()), {});
  ASSERT_THAT(json.at("pushes"), SizeIs(1));
  EXPECT_NEAR(json["pushes"][0].at("from_s").get<double>(), kFromS, 0.1);
  EXPECT_EQ(json["pushes"][0].at("joints").at(0).at("joint"), 1);
  EXPECT_EQ(json["pushes"][0].at("joints").at(0).at("unit"), "N m");
}

TEST(Pushes, AreLeftOutOfTheirRecordingAlone) {
  Log log = recorded(test::serial_arm(2));
  log.file = "mine";
  const auto left_out = [](const char* file, double from_s, double to_s) {
    return Push{file, from_s + 0.1, to_s - 0.1, {}, from_s, to_s};
  };
  leave_out({left_out("mine", 2, 3), left_out("other", 5, 6), left_out("mine", 50, 60)}, log);
  ASSERT_THAT(log.left_out, SizeIs(2));
  for (const LeftOut& out : log.left_out) {
    EXPECT_NEAR(log.t_s[out.rows.first], 2, 1e-9);
    EXPECT_NEAR(log.t_s[out.rows.last], 3, 1e-9);
  }
}

TEST(Pushes, AreSaidInWords) {
  EXPECT_EQ(words_of(Push{"a.csv", 1, 2.5, {{0, 3, "N m"}}, 1, 2.5}),
            "1.00 to 2.50 s of a.csv (joint 1: 3 N m)");
  EXPECT_EQ(words_of(Push{"a.csv", 1, 2.5, {{0, 3, "N m"}, {2, 5.25, "N"}}, 1, 2.5}),
            "1.00 to 2.50 s of a.csv (joints 1, 3; most on joint 3: 5.25 N)");
}

}  // namespace
}  // namespace offnominal::desk
