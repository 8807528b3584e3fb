#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "robot/doubts_of_limits.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

namespace offnominal::desk {
namespace {

RobotDescription content() { return parse_robot(test::kSampleRobot, "sample.toml"); }

TEST(RobotFileContent, HoldsTheJoints) {
  const RobotDescription robot = content();
  EXPECT_EQ(robot.name, "sample");
  EXPECT_EQ(robot.source, "made up");
  EXPECT_EQ(robot.gravity_m_s2, (std::array{0.0, 0.0, -9.81}));
  ASSERT_EQ(robot.joint_count(), 2);
  const RobotJoint& turn = robot.joints[0];
  EXPECT_EQ(turn.name, "turn");
  EXPECT_EQ(turn.source, "drawing 12");
  EXPECT_EQ(turn.joint.type, JointType::kRevolute);
  EXPECT_EQ(turn.joint.axis, (std::array{0.0, 0.0, 1.0}));
  EXPECT_EQ(turn.joint.origin_m, (std::array{0.0, 0.0, 0.3}));
  EXPECT_EQ(turn.joint.mass_kg, 2.5);
  EXPECT_EQ(turn.joint.centre_of_mass_m, (std::array{0.1, 0.0, -0.05}));
  EXPECT_EQ(turn.joint.inertia_kg_m2, (std::array{0.02, 0.03, 0.025, 0.001, 0.0, -0.002}));
  EXPECT_EQ(turn.joint.min_position, -3);
  EXPECT_EQ(turn.joint.max_position, 3);
  EXPECT_EQ(turn.joint.max_velocity, 4);
  EXPECT_EQ(turn.joint.max_torque, 50);
  EXPECT_DOUBLE_EQ(turn.encoder.counts_per_unit, 131072 / (2 * std::numbers::pi));
  EXPECT_EQ(turn.kp, 100);
  EXPECT_EQ(turn.kd, 20);

  const RobotJoint& slide = robot.joints[1];
  EXPECT_EQ(slide.joint.type, JointType::kPrismatic);
  EXPECT_EQ(slide.joint.rotation, (std::array{0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(slide.joint.inertia_kg_m2, Joint<double>{}.inertia_kg_m2);
  EXPECT_EQ(slide.joint.max_torque, Joint<double>{}.max_torque);
  EXPECT_EQ(slide.encoder.counts_per_unit, 2e7);
}

TEST(RobotFileContent, HoldsTheEffectsInTheirOrder) {
  const RobotDescription robot = content();
  ASSERT_EQ(robot.effects.size(), 2U);
  EXPECT_EQ(robot.effects[0].kind, EffectKind::kStribeckFriction);
  EXPECT_EQ(robot.effects[0].joint, 0);
  EXPECT_EQ(robot.effects[0].parameters, (std::array<double, kMaxEffectParameters>{1.5, 0.2, 0.01}))
      << "default smoothing";
  EXPECT_TRUE(robot.effects[0].fitted);
  EXPECT_EQ(robot.effects[0].source, "add, log A");
  EXPECT_EQ(robot.effects[1].kind, EffectKind::kViscousFriction);
  EXPECT_EQ(robot.effects[1].joint, 1);
  EXPECT_EQ(robot.effects[1].parameters, (std::array<double, kMaxEffectParameters>{12.0}));
  EXPECT_FALSE(robot.effects[1].fitted);
}

TEST(RobotFileContent, HoldsEstimatorBoundAndChannels) {
  const RobotDescription robot = content();
  EXPECT_EQ(robot.estimator.period_s, 0.002);
  EXPECT_EQ(robot.estimator.alpha, 20);
  EXPECT_EQ(robot.estimator.hidden_units, 12);
  EXPECT_EQ(robot.estimator.learning_rate, 0.5);
  EXPECT_EQ(robot.estimator.weight_radius, 3);
  EXPECT_EQ(robot.estimator.initial_weight_range, 0.2);
  EXPECT_EQ(robot.estimator.seed, 7U);
  EXPECT_EQ(robot.estimator.dead_zone, DeadZone::kDiscontinuous);
  EXPECT_EQ(robot.estimator.torque_signal, TorqueSignal::kHeld);
  EXPECT_EQ(robot.arming.position_window, (std::vector{0.1, 0.02}));
  EXPECT_EQ(robot.arming.speed, (std::vector{0.2, 0.03}));
  EXPECT_EQ(robot.arming.torque_rate, (std::vector{500.0, 60.0}));
  EXPECT_EQ(robot.arming.ramp_s, 0.5);
  ASSERT_TRUE(robot.bound);
  EXPECT_EQ(robot.bound->kind, BoundSettings::Kind::kTable);
  EXPECT_EQ(robot.bound->table.variable, BoundVariable::kTorque);
  EXPECT_EQ(robot.bound->table.joint, 1);
  EXPECT_EQ(robot.bound->table.at, (std::vector{0.0, 10.0}));
  EXPECT_EQ(robot.bound->table.value, (std::vector{1.0, 2.5}));
  ASSERT_TRUE(robot.channels);
  EXPECT_EQ(robot.channels->time.source, "t");
  ASSERT_EQ(robot.channels->torque.size(), 2U);
  EXPECT_EQ(robot.channels->torque[0].source, "i1");
  EXPECT_EQ(robot.channels->torque[0].scale, 0.5);
  EXPECT_EQ(robot.channels->position[1].source, "b");
}

TEST(RobotFileContent, LeavesOutWhatTheFileLeavesOut) {
  const RobotDescription robot = parse_robot(
      "format = 1\nname = \"r\"\ngravity_m_s2 = [0, 0, 0]\n[[joint]]\nname = \"j\"\n"
      "type = \"revolute\"\naxis = [1, 0, 0]\n[joint.link]\nmass_kg = 1\n"
      "centre_of_mass_m = [0, 0, 0]\n",
      "r.toml");
  EXPECT_EQ(robot.estimator.alpha, EstimatorSettings{}.alpha);
  EXPECT_FALSE(robot.bound);
  EXPECT_FALSE(robot.channels);
  EXPECT_TRUE(robot.effects.empty());
  EXPECT_EQ(robot.joints[0].joint.rotation, Joint<double>{}.rotation);
  EXPECT_EQ(robot.joints[0].encoder.counts_per_unit, 0);
}

TEST(RobotFileContent, MakesAnAxisThatIsNearlyAUnitVectorOne) {
  const std::string text =
      test::changed(test::kSampleRobot, "[0.0, 0.0, 1.0]", "[0.7071068, 0.0, 0.7071068]");
  const auto axis = parse_robot(text, "r.toml").joints[0].joint.axis;
  EXPECT_DOUBLE_EQ(axis[0], std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(axis[2], std::sqrt(0.5));
}

// Radians that are round as degrees are, and more turns than most joints make; 6.28 is a turn, 1000
// an axis that turns on and on.
TEST(RobotFileContent, LeavesDoubtsWhereLimitsLookLikeDegrees) {
  const auto doubts_with = [](const std::string& limits) {
    return doubts_of_limits(parse_robot(
        test::changed(test::kSampleRobot, "position = [-3.0, 3.0]", "position = " + limits),
        "sample.toml"));
  };
  for (const char* limits : {"[-180.0, 180.0]", "[-170, 170]", "[0.0, 90.0]", "[-360, 360]"}) {
    EXPECT_EQ(doubts_with(limits).size(), 1U) << limits;
  }
  for (const char* limits : {"[-3.0, 3.0]", "[-20.0, 20.0]", "[-62.83185, 62.83185]",
                             "[-1000.0, 1000.0]", "[-100.5, 100.5]"}) {
    EXPECT_TRUE(doubts_with(limits).empty()) << limits;
  }
  const std::string doubt = doubts_with("[-180.0, 180.0]").front();
  EXPECT_NE(doubt.find("joint 1 (turn)"), std::string::npos) << doubt;
  EXPECT_NE(doubt.find("57.3 turns"), std::string::npos) << doubt;
  EXPECT_NE(doubt.find("write [-3.14159, 3.14159]"), std::string::npos) << doubt;
}

}  // namespace
}  // namespace offnominal::desk
