// The joint controller that goes on more slowly once something is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "joint_on_desk.hpp"
#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::AtDetection;
using controller::Fault;
using hal::ControllerState;

using ByJoint = ScriptedJointsIn<TorqueSpace>;

ByJoint::Config watchful(AtDetection at_detection) {
  auto config = ByJoint::default_config();
  config.monitor.bound.joints[0].value[0] = 5;
  config.monitor.bound.joints[1].value[0] = 3;
  config.at_detection = at_detection;
  config.slow_down = {0.25, 0.1};
  return config;
}

// The drive says that it gives so much, and its joint does not move.
void give_in_vain(ByJoint& arm, float torque_n) {
  arm.follows[1] = false;
  arm.drives.joints[1].status = {hal::DriveMode::kTorque, 0, torque_n};
}

// With every time that the reference is asked for.
void remember_times(ByJoint& arm, std::vector<double>& times_s) {
  arm.reference_at = [&times_s](double time_s) {
    times_s.push_back(time_s);
    return Reference<2, double>{};
  };
}

TEST(SlowingController, GivenAFaultThenTheMotionsTimeRunsMoreSlowlyAndGoesOn) {
  ByJoint arm(watchful(AtDetection::kSlow));
  std::vector<double> times_s;
  remember_times(arm, times_s);
  ASSERT_TRUE(arm.start());
  arm.run(20);
  ASSERT_FALSE(arm.data->slows);
  give_in_vain(arm, 9);
  while (!arm.data->output.detector.acts) arm.tick();
  ASSERT_TRUE(arm.data->slows);
  const std::uint64_t begun = arm.data->run_ticks;
  EXPECT_EQ(arm.data->slow_since, begun);
  EXPECT_EQ(times_s.back(), 0.001 * static_cast<double>(begun)) << "from here on, not with a jump";
  double last_step_s = 0.001;
  for (int i = 0; i < 100; ++i) {
    const double before_s = times_s.back();
    arm.tick();
    const double step_s = times_s.back() - before_s;
    EXPECT_LE(step_s, last_step_s + 1e-12);
    EXPECT_GE(step_s, last_step_s - 0.001 * largest_pace_rate(arm.controller.config().slow_down) *
                                        0.001 * 1.001);
    last_step_s = step_s;
  }
  EXPECT_EQ(arm.controller.pace(*arm.data).share, 0.25);
  const double slow_s = times_s.back();
  arm.run(400);
  EXPECT_NEAR(times_s.back() - slow_s, 0.1, 1e-9);
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
  EXPECT_EQ(arm.fault(), Fault::kNone);
}

// Ticks that are left out take the motion's time along, slowed as it is.
TEST(SlowingController, GivenLateTicksThenTheMotionIsWhereItWouldBeWithoutThem) {
  std::vector<double> times_s[2];
  for (const bool late : {false, true}) {
    ByJoint arm(watchful(AtDetection::kSlow));
    remember_times(arm, times_s[late ? 1 : 0]);
    ASSERT_TRUE(arm.start());
    give_in_vain(arm, 9);
    while (!arm.data->slows) arm.tick();
    arm.run(20);
    if (late) {
      arm.tick(2);
      arm.run(27);
    } else {
      arm.run(30);
    }
    ASSERT_EQ(arm.state(), ControllerState::kArmed);
  }
  EXPECT_EQ(times_s[0].back(), times_s[1].back());
}

TEST(SlowingController, StaysSlowWhenTheFaultIsOverUntilItIsArmedAnew) {
  ByJoint arm(watchful(AtDetection::kSlow));
  std::vector<double> times_s;
  remember_times(arm, times_s);
  ASSERT_TRUE(arm.start());
  give_in_vain(arm, 9);
  while (!arm.data->slows) arm.tick();
  arm.follows[1] = true;
  arm.run(2000);
  EXPECT_FALSE(arm.data->output.detector.level);
  EXPECT_TRUE(arm.data->slows) << "it is latched, as the detection is";
  ASSERT_TRUE(arm.disarm());
  arm.tick();
  ASSERT_TRUE(arm.arm());
  arm.run(20);
  EXPECT_FALSE(arm.data->slows);
  EXPECT_EQ(arm.controller.pace(*arm.data).share, 1);
  EXPECT_EQ(times_s.back(), 0.001 * static_cast<double>(arm.data->run_ticks));
}

// What is only noticed slows nothing, and neither does a configuration that says to report.
TEST(SlowingController, GivenWhatIsOnlyNoticedThenTheMotionKeepsItsPace) {
  auto noticing = watchful(AtDetection::kSlow);
  noticing.monitor.bound.joints[1].act_ratio = 4;
  for (const auto& config : {noticing, watchful(AtDetection::kReport)}) {
    ByJoint arm(config);
    std::vector<double> times_s;
    remember_times(arm, times_s);
    ASSERT_TRUE(arm.start());
    give_in_vain(arm, 9);
    arm.run(500);
    ASSERT_TRUE(arm.data->output.detector.latched);
    EXPECT_FALSE(arm.data->slows);
    EXPECT_EQ(times_s.back(), 0.001 * static_cast<double>(arm.data->run_ticks));
  }
}

TEST(SlowingController, SlowsNothingThatSomebodyElseMoves) {
  auto config = watchful(AtDetection::kSlow);
  config.watch_when_passive = true;
  ByJoint arm(config);
  arm.become_passive();
  arm.run(20);
  give_in_vain(arm, 9);
  arm.run(500);
  ASSERT_EQ(arm.state(), ControllerState::kPassive);
  ASSERT_TRUE(arm.data->output.detector.acts);
  EXPECT_FALSE(arm.data->slows);
}

TEST(SlowingController, IsRefusedWithAPaceThatIsNone) {
  ByJoint::Controller controller;
  for (const double to : {1.0, -0.5, std::numeric_limits<double>::quiet_NaN()}) {
    auto config = watchful(AtDetection::kSlow);
    config.slow_down.to = to;
    EXPECT_EQ(ByJoint::Controller::create(config, controller), Status::kInvalidLimit) << to;
  }
  auto config = watchful(AtDetection::kSlow);
  config.at_detection = static_cast<AtDetection>(3);
  EXPECT_EQ(ByJoint::Controller::create(config, controller), Status::kInvalidLimit);
}

// A joint that swings, with friction from a moment on.
class SwingingJoint : public JointOnDeskIn<TorqueSpace> {
 public:
  static Config swinging(AtDetection at_detection, float bound_nm) {
    Config all = config();
    all.monitor.bound.joints[0].value[0] = bound_nm;
    all.monitor.estimator.learning_rate = 0;  // the residual stays what it is of
    all.at_detection = at_detection;
    all.slow_down = {0.25F, 0.5F};
    return all;
  }
  explicit SwingingJoint(const Config& config) : JointOnDeskIn<TorqueSpace>(config) {
    reference_at = [](double time_s) {
      return at(static_cast<float>(0.5 * (1 - std::cos(3 * time_s))),
                static_cast<float>(1.5 * std::sin(3 * time_s)),
                static_cast<float>(4.5 * std::cos(3 * time_s)));
    };
    EXPECT_EQ(start(), Fault::kNone);
  }
  void tick_with(double friction_nm) {
    push_nm = -friction_nm * std::tanh(dq / 0.02);
    tick();
  }
};

// Bit for bit: who is not slowed pays nothing for it.
TEST(SlowingController, GivenAHealthyJointThenItsTorquesAreThoseOfOneThatDoesNotSlow) {
  SwingingJoint slowing(SwingingJoint::swinging(AtDetection::kSlow, 2));
  SwingingJoint other(SwingingJoint::swinging(AtDetection::kReport, 2));
  for (int i = 0; i < 4000; ++i) {
    slowing.tick_with(0);
    other.tick_with(0);
    ASSERT_EQ(slowing.torque(), other.torque()) << i;
  }
  EXPECT_NE(slowing.torque(), 0);
}

TEST(SlowingController, GivenFrictionThenTheJointIsSlowedWithoutAJumpAndStillFollowsAndIsWatched) {
  constexpr double kFriction = 6;
  SwingingJoint joint(SwingingJoint::swinging(AtDetection::kSlow, 2));
  SwingingJoint other(SwingingJoint::swinging(AtDetection::kReport, 2));
  double fastest = 0;
  double jump = 0;
  double jump_of_other = 0;
  double furthest_off = 0;
  double furthest_off_of_other = 0;
  double residual = 0;
  const auto run = [&](int ticks, double friction_nm) {
    fastest = jump = jump_of_other = furthest_off = furthest_off_of_other = residual = 0;
    for (int i = 0; i < ticks; ++i) {
      const float before = joint.torque();
      const float before_of_other = other.torque();
      joint.tick_with(friction_nm);
      other.tick_with(friction_nm);
      fastest = std::max(fastest, std::fabs(joint.dq));
      jump = std::max(jump, static_cast<double>(std::fabs(joint.torque() - before)));
      jump_of_other =
          std::max(jump_of_other, static_cast<double>(std::fabs(other.torque() - before_of_other)));
      const auto off = [](const SwingingJoint& one) {
        const double time_s = 0.001 * static_cast<double>(one.data->run_ticks) -
                              one.controller.pace(*one.data).behind_s;
        return std::fabs(one.q - 0.5 * (1 - std::cos(3 * time_s)));
      };
      residual = std::max(residual, static_cast<double>(std::fabs(joint.data->output.error[0])));
      furthest_off = std::max(furthest_off, off(joint));
      furthest_off_of_other = std::max(furthest_off_of_other, off(other));
    }
  };
  run(4000, 0);
  ASSERT_FALSE(joint.data->output.detector.latched);
  EXPECT_NEAR(fastest, 1.5, 0.05);
  run(1500, kFriction);
  ASSERT_TRUE(joint.data->slows);
  EXPECT_FALSE(other.data->slows);
  EXPECT_LE(jump, jump_of_other * 1.05) << "N m in a tick";
  EXPECT_LE(furthest_off, furthest_off_of_other * 1.05);
  run(8000, kFriction);
  EXPECT_NEAR(fastest, 0.25 * 1.5, 0.05);
  EXPECT_LE(furthest_off, furthest_off_of_other * 1.05);
  // The monitor knows of torques and motion alone: friction is seen as before, and its end too.
  EXPECT_NEAR(residual, kFriction, 0.2);
  run(2000, 0);
  run(8000, 0);
  EXPECT_LT(residual, 0.2);
}

// Compensation is no choice among these: it goes with slowing.
TEST(SlowingController, CompensatesTooWhereItMay) {
  auto config = SwingingJoint::swinging(AtDetection::kSlow, 2);
  config.monitor.max_compensation.fill(100);
  config.monitor.estimator.learning_rate =
      JointOnDeskIn<TorqueSpace>::config().monitor.estimator.learning_rate;
  SwingingJoint joint(config);
  for (int i = 0; i < 4000; ++i) joint.tick_with(0);
  for (int i = 0; i < 4000; ++i) joint.tick_with(6);
  EXPECT_TRUE(joint.data->slows);
  EXPECT_NE(joint.controller.acting_compensation(*joint.data)[0], 0);
}

}  // namespace
}  // namespace offnominal::test
