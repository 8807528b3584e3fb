// What a controller asks for before it takes an arm, and that a run begins anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

// Neither the state nor a command has changed, and the next ticks go on so.
void expect_untouched(JointOnDesk& joint) {
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  joint.ticks(3);
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  EXPECT_EQ(joint.data->fault, Fault::kNone);
  EXPECT_EQ(joint.mode(), DriveMode::kOff);
}

TEST(Arming, TakesPassiveAndAFreshSample) {
  JointOnDesk joint;
  EXPECT_EQ(joint.arm(), Fault::kNotPassive);
  joint.ticks(2);
  ASSERT_EQ(joint.data->state, ControllerState::kPassive);
  joint.encoder_speaks = false;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNoFreshSample);
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  joint.encoder_speaks = true;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNone);
  EXPECT_EQ(joint.arm(), Fault::kNotPassive) << "armed twice";
}

TEST(Arming, RefusesAReferenceFarFromTheArm) {
  JointOnDesk joint;
  joint.reference_at = [](double) { return at(2.5F); };
  joint.ticks(2);
  EXPECT_EQ(joint.arm(), Fault::kReferenceFarFromArm);
  expect_untouched(joint);
  joint.reference_at = [](double) { return at(-0.0501F); };
  EXPECT_EQ(joint.arm(), Fault::kReferenceFarFromArm) << "either way";
  joint.reference_at = [](double) { return at(-0.0499F); };
  EXPECT_EQ(joint.arm(), Fault::kNone);
}

TEST(Arming, RefusesAnArmThatMoves) {
  JointOnDesk joint;
  joint.ticks(2);
  for (const double speed : {0.051, -0.051}) {
    joint.dq = speed;
    joint.tick();
    EXPECT_EQ(joint.arm(), Fault::kArmMoving) << speed;
  }
  joint.dq = 0.049;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNone);
}

TEST(Arming, RefusesAReferenceThatMovesUnlessItIsAllowedTo) {
  JointOnDesk resting;
  resting.reference_at = [](double time_s) { return at(static_cast<float>(0.3 * time_s), 0.3F); };
  resting.ticks(2);
  EXPECT_EQ(resting.arm(), Fault::kReferenceMoving);
  expect_untouched(resting);
  auto config = JointOnDesk::config();
  config.arming.speed.fill(0.35F);
  JointOnDesk moving(config);
  moving.reference_at = resting.reference_at;
  moving.dq = 0.3;
  moving.ticks(2);
  EXPECT_EQ(moving.arm(), Fault::kNone);
}

TEST(Arming, RefusesGainsOfZero) {
  for (const bool proportional : {true, false}) {
    auto config = JointOnDesk::config();
    (proportional ? config.gains.kp : config.gains.kd).fill(0);
    JointOnDesk joint(config);
    joint.ticks(2);
    EXPECT_EQ(joint.arm(), Fault::kNoGains);
    expect_untouched(joint);
  }
}

TEST(Arming, RefusesATorqueWithoutALimit) {
  auto config = JointOnDesk::config();
  config.monitor.chain.joints[0].max_torque = std::numeric_limits<float>::max();
  JointOnDesk joint(config);
  joint.ticks(2);
  EXPECT_EQ(joint.arm(), Fault::kNoTorqueLimit);
  expect_untouched(joint);
}

TEST(Arming, RefusesAReferenceThatIsNone) {
  JointOnDesk joint;
  joint.ticks(2);
  joint.reference_at = [](double) { return at(std::numeric_limits<float>::quiet_NaN()); };
  EXPECT_EQ(joint.arm(), controller::fault_of(Status::kNonFiniteReference));
  joint.reference_at = [](double) { return at(1e30F); };
  EXPECT_EQ(joint.arm(), Fault::kReferenceOutOfRange);
  expect_untouched(joint);
}

// GIVEN arm() has said yes WHEN the arm is pushed away before the next sample THEN that is a fault,
// and no torque is commanded.
TEST(Arming, JudgesAgainAtTheFirstSample) {
  JointOnDesk joint;
  joint.ticks(2);
  ASSERT_EQ(joint.arm(), Fault::kNone);
  joint.q = 1;
  joint.tick();
  EXPECT_EQ(joint.data->state, ControllerState::kFault);
  EXPECT_EQ(joint.data->fault, Fault::kReferenceFarFromArm);
  EXPECT_EQ(joint.mode(), DriveMode::kOff);
  EXPECT_EQ(joint.drive.heartbeat.fault, 185);
}

// GIVEN a run WHEN it is disarmed and armed again without a tick between THEN the next one knows
// nothing of it: it is judged at its first sample, and its torque and its ramp begin anew.
TEST(Arming, OfARunThatWasJustDisarmedBeginsAnew) {
  JointOnDesk pushed;
  ASSERT_EQ(pushed.start(), Fault::kNone);
  pushed.ticks(100);
  ASSERT_TRUE(pushed.controller.disarm(*pushed.data));
  ASSERT_EQ(pushed.arm(), Fault::kNone);
  pushed.q = 1;
  pushed.tick();
  EXPECT_EQ(pushed.data->fault, Fault::kReferenceFarFromArm);
  EXPECT_EQ(pushed.mode(), DriveMode::kOff);

  auto config = JointOnDesk::config();
  config.monitor.chain.gravity_m_s2 = {0, -9.81F, 0};
  JointOnDesk joint(config);
  joint.push_nm = -9.81 * JointOnDesk::kInertia;
  joint.reference_at = [](double) { return at(0.04F); };
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(2000);
  ASSERT_GT(joint.torque(), 19.0F);
  ASSERT_TRUE(joint.controller.disarm(*joint.data));
  ASSERT_EQ(joint.arm(), Fault::kNone);
  joint.tick();
  EXPECT_LE(joint.torque(), 2.001F) << "by the torque rate from 0";
  EXPECT_NEAR(static_cast<double>(joint.data->ramp.q[0]), 0.04 - joint.q, 1e-3);
}

TEST(Arming, AConfigurationThatDoesNotSayHowIsRefused) {
  JointOnDesk::Controller controller;
  const auto refused = [&](auto&& change) {
    auto config = JointOnDesk::config();
    change(config);
    return JointOnDesk::Controller::create(config, controller) == Status::kInvalidLimit;
  };
  using Config = JointOnDesk::Config;
  EXPECT_TRUE(refused([](Config& config) { config.arming = {}; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.position_window[0] = 0; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.speed[0] = -1; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.torque_rate[0] = INFINITY; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.ramp_s = NAN; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.ramp_s = 0; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.ramp_s = 0.009F; })) << "9 periods";
  EXPECT_FALSE(refused([](Config& config) { config.arming.ramp_s = 0.01F; }));
  EXPECT_TRUE(refused([](Config& config) { config.most_position = 0; }));
  EXPECT_FALSE(refused([](Config&) {}));
}

}  // namespace
}  // namespace offnominal::test
