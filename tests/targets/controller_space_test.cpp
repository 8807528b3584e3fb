// The joint controller in both spaces of its monitor, and what it tells the bus of joints.
#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/controller/diagnosis_of.hpp>
#include <optional>
#include <vector>

#include "joint_on_desk.hpp"
#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::AtDetection;
using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

// A bound that the torques of these tests exceed: 1 m/s^2, or what that is of each joint.
template <typename Space>
typename ScriptedJointsIn<Space>::Config watchful() {
  auto config = ScriptedJointsIn<Space>::default_config();
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    config.monitor.bound.joints[0].value[0] = 5;
    config.monitor.bound.joints[1].value[0] = 3;
  } else {
    config.monitor.bound.offset = 1;
  }
  return config;
}

// The drive says that it gives so much, and its joint does not move.
template <typename Arm>
void give_in_vain(Arm& arm, std::size_t joint, float torque_n) {
  arm.follows[joint] = false;
  arm.drives.joints[joint].status = {DriveMode::kTorque, 0, torque_n};
}

template <typename Space>
class ControllerInSpace : public testing::Test {};
using BothSpaces = testing::Types<AccelerationSpace, TorqueSpace>;
TYPED_TEST_SUITE(ControllerInSpace, BothSpaces);

TYPED_TEST(ControllerInSpace, GivenAHealthyArmThenNothingIsDetected) {
  ScriptedJointsIn<TypeParam> arm(watchful<TypeParam>());
  ASSERT_TRUE(arm.start());
  arm.run(1000);
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
  EXPECT_FALSE(arm.data->output.detector.latched);
  EXPECT_EQ(arm.data->output.psi_hat.norm(), 0);
}

TYPED_TEST(ControllerInSpace, GivenAFaultOfAJointThenItIsLatchedAndStopsWhereItShall) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    for (const bool stops : {false, true}) {
      auto config = watchful<TypeParam>();
      if (stops) config.at_detection = AtDetection::kStop;
      ScriptedJointsIn<TypeParam> arm(config);
      ASSERT_TRUE(arm.start());
      arm.run(20);
      give_in_vain(arm, joint, 9);
      arm.run(200);
      EXPECT_TRUE(arm.data->output.detector.latched) << joint;
      EXPECT_EQ(arm.fault(), stops ? Fault::kDetected : Fault::kNone) << joint;
    }
  }
}

TYPED_TEST(ControllerInSpace, GivenAPushThenCompensationTakesItAway) {
  constexpr double kPush = 30;
  double way[2] = {0, 0};
  for (const bool acts : {false, true}) {
    auto config = JointOnDeskIn<TypeParam>::config();
    if (acts) config.monitor.max_compensation.fill(100);
    JointOnDeskIn<TypeParam> joint(config);
    ASSERT_EQ(joint.start(), Fault::kNone);
    joint.ticks(1500);
    ASSERT_FALSE(joint.data->output.detector.latched);
    joint.push_nm = kPush;
    joint.ticks(4000);
    EXPECT_TRUE(joint.data->output.detector.latched);
    way[acts ? 1 : 0] = std::abs(joint.q);
    const auto given = static_cast<double>(joint.data->output.compensation.torque[0]);
    // What is beyond the threshold, 10 N m, is learnt.
    EXPECT_NEAR(given, acts ? -(kPush - 10) : 0, 3);
  }
  EXPECT_LT(way[1], 0.5 * way[0]);
}

using ByJoint = ScriptedJointsIn<TorqueSpace>;

TEST(ControllerInTorqueSpace, SaysWhichJointWasFirst) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    ByJoint arm(watchful<TorqueSpace>());
    ASSERT_TRUE(arm.start());
    arm.run(20);
    give_in_vain(arm, joint, 9);
    arm.run(200);
    const auto& detector = arm.data->output.detector;
    ASSERT_TRUE(detector.latched);
    EXPECT_EQ(detector.first_joint, joint);
    EXPECT_TRUE(detector.joints[joint].latched);
    EXPECT_FALSE(detector.joints[1 - joint].latched);
    EXPECT_NEAR(std::abs(arm.data->output.error[static_cast<Eigen::Index>(joint)]), 9, 1.5);
  }
}

// Between two heartbeats, and in the tick of the detection.
TEST(ControllerInTorqueSpace, TellsTheBusWhichJointIsOffNominal) {
  ByJoint arm(watchful<TorqueSpace>());
  ASSERT_TRUE(arm.start());
  arm.run(100);
  const std::size_t before = arm.drives.reports.size();
  EXPECT_EQ(before, (arm.data->ticks + 5) / 10);
  EXPECT_EQ(arm.drives.reports.back().first_joint, 0);
  EXPECT_FALSE(arm.drives.reports.back().level);
  give_in_vain(arm, 1, 9);
  while (!arm.data->output.detector.latched) arm.tick();
  const hal::Diagnosis at_once = arm.drives.reports.back();
  EXPECT_EQ(arm.bus.sent.back().frame.id, ByJoint::Drives::kReportId);
  EXPECT_TRUE(at_once.level);
  EXPECT_EQ(at_once.first_joint, 2);
  EXPECT_EQ(at_once.worst_joint, 2);
  EXPECT_GT(at_once.error_to_threshold, 1);
  EXPECT_LT(at_once.error_to_threshold, 1.2F);
  arm.drives.reports.clear();
  arm.run(100);
  EXPECT_EQ(arm.drives.reports.size(), 10U) << "each crossing is news once";
  EXPECT_GT(arm.drives.reports.back().error_to_threshold, 2);
}

// What is noticed is told; it stops and compensates beyond the second level.
TEST(ControllerInTorqueSpace, GivenTwoLevelsThenItActsBeyondTheSecondAlone) {
  auto config = watchful<TorqueSpace>();
  config.at_detection = AtDetection::kStop;
  config.monitor.bound.joints[1].act_ratio = 4;
  ByJoint noticed(config);
  ASSERT_TRUE(noticed.start());
  noticed.run(20);
  give_in_vain(noticed, 1, 9);  // three times the threshold
  noticed.run(400);
  EXPECT_TRUE(noticed.data->output.detector.latched);
  EXPECT_EQ(noticed.fault(), Fault::kNone);
  EXPECT_EQ(noticed.drives.reports.back().first_joint, 2);
  EXPECT_FALSE(noticed.drives.reports.back().acts);

  config.monitor.bound.joints[1].act_ratio = 2;
  ByJoint stopped(config);
  ASSERT_TRUE(stopped.start());
  stopped.run(20);
  give_in_vain(stopped, 1, 9);
  stopped.run(400);
  EXPECT_EQ(stopped.fault(), Fault::kDetected);
  EXPECT_TRUE(stopped.drives.reports.back().acts);
}

// In the tick that reaches it, not with the next frame that is due.
TEST(ControllerInTorqueSpace, TellsTheBusAtOnceThatTheSecondLevelIsReached) {
  auto config = watchful<TorqueSpace>();
  config.monitor.bound.joints[1].act_ratio = 2;
  ByJoint arm(config);
  ASSERT_TRUE(arm.start());
  // Neither tick is one in which a frame is due.
  for (const int ticks : {21, 22}) {
    arm.run(ticks);
    give_in_vain(arm, 1, 9);
    while (!arm.data->output.detector.acts) arm.tick();
    EXPECT_NE(arm.data->ticks % 10, 5U);
    EXPECT_EQ(arm.data->act_tick, arm.data->ticks);
    EXPECT_EQ(arm.bus.sent.back().frame.id, ByJoint::Drives::kReportId);
    EXPECT_TRUE(arm.drives.reports.back().acts);
    arm.drives.reports.clear();
    arm.run(100);
    EXPECT_EQ(arm.drives.reports.size(), 10U) << "it is news once";
    // Another run is another watch.
    ASSERT_TRUE(arm.disarm());
    arm.follows[1] = true;
    arm.tick();
    ASSERT_TRUE(arm.arm());
    arm.run(3);
    EXPECT_FALSE(arm.data->output.detector.acts);
  }
}

// A push that is over before the slow filter has it.
TEST(ControllerInTorqueSpace, GivenASecondFilterThenItSeesWhatIsShort) {
  for (const bool has_fast : {false, true}) {
    auto config = watchful<TorqueSpace>();
    if (has_fast) {
      config.monitor.bound.fast.alpha = 100;
      config.monitor.bound.fast.joints[0].value[0] = 5;
      config.monitor.bound.fast.joints[1].value[0] = 5;
    }
    ByJoint arm(config);
    ASSERT_TRUE(arm.start());
    arm.run(20);
    give_in_vain(arm, 1, 9);
    arm.run(20);
    EXPECT_EQ(arm.data->output.detector.latched, has_fast);
    if (!has_fast) continue;
    EXPECT_EQ(arm.drives.reports.back().worst_joint, 2);
    EXPECT_GT(arm.drives.reports.back().error_to_threshold, 1) << "of the filter that saw it";
  }
}

TEST(ControllerInTorqueSpace, TellsAfterItHasStoppedWhoWasFirstAndNoMore) {
  auto config = watchful<TorqueSpace>();
  config.at_detection = AtDetection::kStop;
  ByJoint arm(config);
  ASSERT_TRUE(arm.start());
  arm.run(20);
  give_in_vain(arm, 0, 9);
  arm.run(200);
  ASSERT_EQ(arm.fault(), Fault::kDetected);
  const hal::Diagnosis last = arm.drives.reports.back();
  EXPECT_EQ(last.first_joint, 1);
  EXPECT_EQ(last.worst_joint, 0);
  EXPECT_FALSE(last.level);
  EXPECT_EQ(last.error_to_threshold, 0);
  // Another run is another watch.
  ASSERT_TRUE(arm.clear_fault());
  arm.follows[0] = true;
  arm.tick();
  ASSERT_TRUE(arm.arm());
  arm.run(20);
  EXPECT_EQ(arm.drives.reports.back().first_joint, 0);
}

TEST(ControllerInAccelerationSpace, TellsTheBusNothingOfJoints) {
  ScriptedJoints arm(watchful<AccelerationSpace>());
  ASSERT_TRUE(arm.start());
  give_in_vain(arm, 0, 9);
  arm.run(200);
  ASSERT_TRUE(arm.data->output.detector.latched);
  EXPECT_TRUE(arm.drives.reports.empty());
}

TEST(DiagnosisOf, NamesTheJointThatIsNearestToItsThreshold) {
  MonitorOutput<3, float, TorqueSpace> output;
  output.worst_joint = 1;
  output.error_norm = 3;
  output.threshold = 4;
  hal::Diagnosis found = controller::diagnosis_of(output, true);
  EXPECT_EQ(found.worst_joint, 2);
  EXPECT_EQ(found.error_to_threshold, 0.75F);
  EXPECT_EQ(found.first_joint, 0);
  output.detector.latched = true;
  output.detector.first_joint = 2;
  EXPECT_EQ(controller::diagnosis_of(output, true).first_joint, 3);
  // Thresholds begin at 0.
  output.threshold = 0;
  EXPECT_GT(controller::diagnosis_of(output, true).error_to_threshold, 1e5F);
  output.error_norm = 0;
  found = controller::diagnosis_of(output, true);
  EXPECT_EQ(found.error_to_threshold, 0);
}

using Isolating = JointOnDeskIn<TorqueSpace, WithIsolation>;

// A joint that sways, on a controller that may compensate or not.
Isolating swaying(bool may, double act_ratio = 1) {
  auto config = Isolating::config();
  if (may) config.monitor.max_compensation.fill(100);
  config.monitor.bound.joints[0].value[0] = 2;
  config.monitor.bound.joints[0].act_ratio = static_cast<float>(act_ratio);
  Isolating joint(config);
  joint.reference_at = [](double t_s) {
    constexpr double kSpeed = 3;
    const auto at = static_cast<float>(0.5 * (1 - std::cos(kSpeed * t_s)));
    const auto speed = static_cast<float>(0.5 * kSpeed * std::sin(kSpeed * t_s));
    const auto rate = static_cast<float>(0.5 * kSpeed * kSpeed * std::cos(kSpeed * t_s));
    Reference<1, float> reference;
    reference.q[0] = at;
    reference.dq[0] = speed;
    reference.ddq[0] = rate;
    return reference;
  };
  EXPECT_EQ(joint.start(), Fault::kNone);
  joint.ticks(4000);
  EXPECT_FALSE(joint.data->output.detector.latched);
  EXPECT_TRUE(joint.drive.faults.empty());
  return joint;
}

TEST(ControllerWithIsolation, GivenFrictionThenItSaysSoAndCompensatesOnceItIsDecided) {
  Isolating joint = swaying(true);
  Isolating without = swaying(false);
  std::optional<int> decided_at;
  std::optional<int> differs_at;
  float largest = 0;
  for (int i = 0; i < 3000; ++i) {
    for (Isolating* one : {&joint, &without}) {
      one->push_nm = -6 * std::tanh(one->dq / 0.02);
      one->tick();
    }
    if (!decided_at && joint.data->isolation.diagnosis.decided) decided_at = i;
    if (!differs_at && joint.torque() != without.torque()) differs_at = i;
    if (decided_at) {
      largest = std::max(largest, std::abs(joint.data->output.compensation.torque[0]));
    }
  }
  ASSERT_TRUE(decided_at && differs_at);
  EXPECT_GE(*differs_at, *decided_at);
  EXPECT_GT(largest, 1);
  const auto& found = joint.data->isolation.diagnosis;
  ASSERT_TRUE(found.decided);
  EXPECT_EQ(found.kind, FaultKind::kFriction) << name_of(found.kind);
  EXPECT_NEAR(found.size, 6, 0.9);
  ASSERT_FALSE(joint.drive.faults.empty());
  const hal::FaultReport& told = joint.drive.faults.back();
  EXPECT_EQ(told.kind, static_cast<std::uint8_t>(FaultKind::kFriction));
  EXPECT_EQ(told.joint, 1);
  EXPECT_TRUE(told.decided);
  EXPECT_EQ(told.size, static_cast<float>(found.size));
  EXPECT_FALSE(joint.drive.faults.front().decided) << "the best answer so far comes first";
}

// Its law is of a joint that was only noticed.
TEST(ControllerWithIsolation, GivenTwoLevelsThenAFaultBelowTheSecondIsNamedAndNotCompensated) {
  for (const double act_ratio : {1.0, 1000.0}) {
    Isolating joint = swaying(true, act_ratio);
    float largest = 0;
    for (int i = 0; i < 3000; ++i) {
      joint.push_nm = -6 * std::tanh(joint.dq / 0.02);
      joint.tick();
      largest = std::max(largest, std::abs(joint.data->output.compensation.torque[0]));
    }
    EXPECT_TRUE(joint.data->isolation.diagnosis.decided);
    EXPECT_EQ(joint.data->output.detector.acts, act_ratio == 1);
    EXPECT_EQ(largest > 1, act_ratio == 1) << largest;
    EXPECT_EQ(largest == 0, act_ratio != 1) << largest;
  }
}

// GIVEN friction that is compensated WHEN it is over THEN the controller lets go of it: it moves as
// one that never had any.
TEST(ControllerWithIsolation, GivenFrictionThatGoesThenItsCompensationGoes) {
  Isolating joint = swaying(true);
  Isolating without = swaying(false);
  Isolating healthy = swaying(true);
  double off = 0;
  double off_without = 0;
  const auto run = [&](int ticks, double friction_nm) {
    off = off_without = 0;
    for (int i = 0; i < ticks; ++i) {
      for (Isolating* one : {&joint, &without}) {
        one->push_nm = -friction_nm * std::tanh(one->dq / 0.02);
        one->tick();
      }
      healthy.tick();
      off += std::pow(joint.q - healthy.q, 2);
      off_without += std::pow(without.q - healthy.q, 2);
    }
  };
  run(3000, 6);
  ASSERT_TRUE(joint.data->isolation.law.known);
  run(1500, 6);
  EXPECT_LT(off, 0.1 * off_without);
  EXPECT_NEAR(std::abs(joint.controller.acting_compensation(*joint.data)[0]), 6, 1.5);
  EXPECT_EQ(healthy.controller.acting_compensation(*healthy.data)[0], 0);
  run(2000, 0);
  EXPECT_FALSE(joint.data->isolation.law.known);
  EXPECT_TRUE(joint.data->isolation.diagnosis.decided) << "what it was stays said";
  run(4000, 0);
  run(1500, 0);
  EXPECT_LT(std::sqrt(off / 1500), 0.01) << "what the network had learnt fades more slowly";
  EXPECT_TRUE(healthy.drive.faults.empty());
  ASSERT_TRUE(joint.controller.disarm(*joint.data));
  EXPECT_EQ(joint.controller.acting_compensation(*joint.data)[0], 0) << "nothing is commanded";
}

// GIVEN a joint that something holds WHEN that is decided THEN nothing is compensated: the torque
// is what it would be without any compensation.
TEST(ControllerWithIsolation, GivenAJointThatIsHeldThenNothingIsCompensated) {
  std::vector<float> torques[2];
  for (const bool may : {false, true}) {
    Isolating joint = swaying(may);
    joint.brake_at = joint.q;
    for (int i = 0; i < 4500; ++i) {
      joint.tick();
      torques[may ? 1 : 0].push_back(joint.torque());
    }
    if (!may) continue;
    const auto& found = joint.data->isolation.diagnosis;
    EXPECT_TRUE(found.decided);
    EXPECT_FALSE(is_compensated(found.kind)) << name_of(found.kind);
    EXPECT_GT(std::abs(joint.data->output.compensation.torque[0]), 0.1)
        << "it would have something to compensate";
  }
  EXPECT_EQ(torques[0], torques[1]);
}

TEST(ControllerWithIsolation, IsNotAskedWhereTheConfigurationSaysSo) {
  auto config = Isolating::config();
  config.isolates = false;
  config.monitor.max_compensation.fill(100);
  Isolating joint(config);
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(1500);
  joint.push_nm = 30;
  joint.ticks(1000);
  EXPECT_TRUE(joint.data->output.detector.latched);
  EXPECT_FALSE(joint.data->isolation.triggered);
  EXPECT_TRUE(joint.drive.faults.empty());
  EXPECT_NE(joint.data->output.compensation.torque[0], 0);
}

}  // namespace
}  // namespace offnominal::test
