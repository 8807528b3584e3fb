#include "robot/chain_of.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "robot/monitor_config_of.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

namespace offnominal::desk {
namespace {

RobotDescription sample() { return parse_robot(test::kSampleRobot, "sample.toml"); }

TEST(ChainOf, HoldsWhatTheRobotSays) {
  const RobotDescription robot = sample();
  const auto chain = chain_of<2, double>(robot);
  EXPECT_EQ(validate(chain), Status::kOk);
  EXPECT_EQ(chain.gravity_m_s2, robot.gravity_m_s2);
  EXPECT_EQ(chain.joints[0].rotation, robot.joints[0].joint.rotation);
  EXPECT_EQ(chain.joints[0].inertia_kg_m2, robot.joints[0].joint.inertia_kg_m2);
  EXPECT_EQ(chain.joints[1].type, JointType::kPrismatic);
  ASSERT_EQ(chain.effects.size, 2);
  EXPECT_EQ(chain.effects.items[0].kind, EffectKind::kStribeckFriction);
  EXPECT_EQ(chain.effects.items[1].joint, 1);
  EXPECT_EQ(chain.effects.items[1].parameters[0], 12);
}

TEST(ChainOf, StaysValidInFloatWithLimitsLeftOpen) {
  const auto chain = chain_of<2, float>(sample());
  EXPECT_EQ(validate(chain), Status::kOk);
  EXPECT_TRUE(std::isfinite(chain.joints[1].max_torque));
  EXPECT_TRUE(std::isfinite(chain.joints[1].min_position));
  EXPECT_EQ(chain.joints[0].mass_kg, 2.5F);
}

TEST(ChainOf, RefusesAnotherNumberOfJointsAndTooManyEffects) {
  RobotDescription robot = sample();
  EXPECT_THROW(static_cast<void>(chain_of<3, double>(robot)), std::invalid_argument);
  robot.effects.resize(17);
  EXPECT_THROW((static_cast<void>(chain_of<kRuntimeJoints, double>(robot))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(chain_of<2, double>(robot)), std::invalid_argument);
}

TEST(ChainOf, TakesAnyNumberOfJointsAtRunTimeUpToTheMost) {
  RobotDescription robot = sample();
  robot.effects.clear();
  for (const int joints : {1, 2, kMaxJoints}) {
    robot.joints.resize(static_cast<std::size_t>(joints), robot.joints.front());
    const auto chain = chain_of<kRuntimeJoints, double>(robot);
    EXPECT_EQ(chain.joints.size(), static_cast<std::size_t>(joints));
    EXPECT_EQ(validate(chain), Status::kOk);
  }
  robot.effects.resize(static_cast<std::size_t>(kEffectsPerJoint * kMaxJoints) + 1);
  EXPECT_THROW((static_cast<void>(chain_of<kRuntimeJoints, double>(robot))), std::invalid_argument);
  robot.effects.clear();
  robot.joints.push_back(robot.joints.front());
  EXPECT_THROW((static_cast<void>(chain_of<kRuntimeJoints, double>(robot))), std::invalid_argument);
  robot.joints.clear();
  EXPECT_THROW((static_cast<void>(chain_of<kRuntimeJoints, double>(robot))), std::invalid_argument);
}

TEST(EstimatorConfigOf, HoldsTheSettings) {
  const auto config = estimator_config_of<float>(sample().estimator);
  EXPECT_EQ(config.period_s, 0.002F);
  EXPECT_EQ(config.alpha, 20);
  EXPECT_EQ(config.learning_rate, 0.5F);
  EXPECT_EQ(config.weight_radius, 3);
  EXPECT_EQ(config.dead_zone, DeadZone::kDiscontinuous);
  EXPECT_EQ(config.hidden_units, 12);
  EXPECT_EQ(config.initial_weight_range, 0.2F);
  EXPECT_EQ(config.seed, 7U);
  EXPECT_EQ(estimator_config_of<double>({}).dead_zone, DeadZone::kContinuous);
}

TEST(BoundOf, EvaluatesEveryKind) {
  const Vector<2, double> q(1, 2);
  const Vector<2, double> dq(-3, 4);
  const Vector<2, double> tau(5, -6);
  BoundSettings settings;
  settings.constant.value = 0.7;
  settings.velocity_error = 0.25;
  EXPECT_EQ((bound_of<2, double>(settings).velocity_error), 0.25);
  EXPECT_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau), 0.7);

  settings.kind = BoundSettings::Kind::kScaledNorm;
  settings.scaled_norm = {4.4, 1.0, {{2.0, -6.0}}};
  EXPECT_DOUBLE_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau), 4.4 * (30 + 1));
  settings.scaled_norm = {2.0, 0.5, {{1.0, 0.0}, {2.0, 0.0}}};
  EXPECT_DOUBLE_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau),
                   2 * (std::sqrt(9.0 + 36.0) + 0.5));

  settings.kind = BoundSettings::Kind::kTable;
  settings.table = {BoundVariable::kTorque, 1, {0.0, 10.0}, {1.0, 2.0}};
  EXPECT_DOUBLE_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau), 1.6);
  settings.table.variable = BoundVariable::kPosition;
  EXPECT_DOUBLE_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau), 1.2);
  settings.table = {BoundVariable::kSpeed, 0, {0.0, 10.0}, {1.0, 2.0}};
  EXPECT_DOUBLE_EQ(evaluate(bound_of<2, double>(settings), q, dq, tau), 1.3);
}

TEST(BoundOf, RefusesWhatDoesNotFitTheJoints) {
  BoundSettings settings;
  settings.kind = BoundSettings::Kind::kScaledNorm;
  settings.scaled_norm.matrix = {{1.0, 2.0, 3.0}};
  EXPECT_THROW(static_cast<void>(bound_of<2, double>(settings)), std::invalid_argument);
  settings.scaled_norm.matrix = {{1.0}, {2.0}};
  EXPECT_THROW(static_cast<void>(bound_of<1, double>(settings)), std::invalid_argument);
  settings.kind = BoundSettings::Kind::kTable;
  settings.table.at.resize(17);
  settings.table.value.resize(17);
  EXPECT_THROW(static_cast<void>(bound_of<1, double>(settings)), std::invalid_argument);
}

TEST(MonitorConfigOf, IsAcceptedByTheCoreInBothScalars) {
  const RobotDescription robot = sample();
  EXPECT_EQ((validate<35>(monitor_config_of<2, double>(robot))), Status::kOk);
  const auto config = monitor_config_of<2, float>(robot);
  EXPECT_EQ(validate<35>(config), Status::kOk);
  EXPECT_EQ(config.max_compensation[0], 50);
  EXPECT_EQ((gains_of<2, double>(robot).kp[0]), 100);
  EXPECT_EQ(config.torque_signal, TorqueSignal::kHeld);
  EXPECT_EQ(EstimatorSettings{}.torque_signal, (MonitorConfig<2, float>{}.torque_signal));
}

TEST(ArmingOf, IsWhatTheFileSaysAndTheDefaultsElsewhere) {
  RobotDescription robot = sample();
  const auto config = arming_of<2, double>(robot);
  EXPECT_EQ(config.position_window, (std::array{0.1, 0.02}));
  EXPECT_EQ(config.speed, (std::array{0.2, 0.03}));
  EXPECT_EQ(config.torque_rate, (std::array{500.0, 60.0}));
  EXPECT_EQ(config.ramp_s, 0.5);
  robot.arming = {};
  const auto otherwise = arming_of<2, double>(robot);
  EXPECT_EQ(otherwise.position_window, (std::array{0.05, 0.01})) << "a turn and a slide";
  EXPECT_EQ(otherwise.torque_rate[0], 1000) << "50 N m in 0.05 s";
  EXPECT_EQ(otherwise.ramp_s, 1);
  robot.arming.speed = {1.0};
  EXPECT_THROW(static_cast<void>(arming_of<2, double>(robot)), std::invalid_argument);
}

TEST(MonitorConfigOf, NeedsABound) {
  RobotDescription robot = sample();
  robot.bound.reset();
  EXPECT_THROW(static_cast<void>(monitor_config_of<2, double>(robot)), std::invalid_argument);
}

}  // namespace
}  // namespace offnominal::desk
