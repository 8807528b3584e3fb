#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "exchange/export_robot.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"
#include "rigid_torque.hpp"
#include "robot/geometry.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"
#include "support/seed.hpp"
#include "urdfs.hpp"

namespace offnominal::test {
namespace {

using desk::RobotDescription;
using desk::exchange::export_urdf;
using desk::exchange::import_urdf;
using desk::exchange::ImportedRobot;
using testing::Contains;
using testing::HasSubstr;

void expect_near(const auto& a, const auto& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

void expect_same_joint(const desk::RobotJoint& a, const desk::RobotJoint& b) {
  SCOPED_TRACE(a.name);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.joint.type, b.joint.type);
  EXPECT_EQ(a.joint.axis, b.joint.axis);
  EXPECT_EQ(a.joint.origin_m, b.joint.origin_m);
  expect_near(a.joint.rotation, b.joint.rotation, 1e-14);
  EXPECT_EQ(a.joint.mass_kg, b.joint.mass_kg);
  EXPECT_EQ(a.joint.centre_of_mass_m, b.joint.centre_of_mass_m);
  EXPECT_EQ(a.joint.inertia_kg_m2, b.joint.inertia_kg_m2);
  EXPECT_EQ(a.joint.min_position, b.joint.min_position);
  EXPECT_EQ(a.joint.max_position, b.joint.max_position);
  EXPECT_EQ(a.joint.max_velocity, b.joint.max_velocity);
  EXPECT_EQ(a.joint.max_torque, b.joint.max_torque);
}

void expect_same_robot(const RobotDescription& a, const RobotDescription& b) {
  EXPECT_EQ(a.name, b.name);
  expect_near(a.gravity_m_s2, b.gravity_m_s2, 1e-12);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) expect_same_joint(a.joints[i], b.joints[i]);
  ASSERT_EQ(a.effects.size(), b.effects.size());
  for (std::size_t i = 0; i < a.effects.size(); ++i) {
    EXPECT_EQ(a.effects[i].kind, b.effects[i].kind);
    EXPECT_EQ(a.effects[i].joint, b.effects[i].joint);
    EXPECT_EQ(a.effects[i].parameters, b.effects[i].parameters);
  }
}

// A base that stands tilted comes back below a link of its own.
ImportedRobot back(const RobotDescription& robot) {
  return import_urdf(export_urdf(robot, "robot.toml").text, "robot.urdf",
                     {"base", robot.joints.back().name + "_link"});
}

class UrdfRoundTrip : public testing::TestWithParam<UrdfCase> {};

TEST_P(UrdfRoundTrip, ThroughARobotFileGivesTheSameRobot) {
  const UrdfCase& of = GetParam();
  OFFNOMINAL_SKIP_WITHOUT(of);
  const ImportedRobot imported = import_urdf(of.text(), of.file.string(), of.chain());
  const RobotDescription robot =
      desk::parse_robot(desk::exchange::robot_text_of(imported, of.file.string()), "robot.toml");
  expect_same_robot(imported.robot, robot);
  const RobotDescription again = back(robot).robot;
  expect_same_robot(robot, again);
  std::mt19937_64 generator = seeded_generator();
  double worst = 0;
  for (int i = 0; i < repetitions(100); ++i) {
    const MotionState state = random_state(generator, of.joints);
    worst = std::max(worst, deviation(torque_of(robot, state), torque_of(again, state)));
  }
  EXPECT_LE(worst, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, UrdfRoundTrip, testing::ValuesIn(all_urdfs()),
                         [](const auto& one) { return one.param.name; });

RobotDescription sample() {
  return import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain()).robot;
}

TEST(UrdfExport, KeepsEveryRotationAlsoWhereThePitchIsARightAngle) {
  std::mt19937_64 generator = seeded_generator();
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
  RobotDescription robot = sample();
  for (int i = 0; i < repetitions(400); ++i) {
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      // Right angles, some of them missed by a little.
      const double near[]{angle(generator), std::numbers::pi / 2, -std::numbers::pi / 2,
                          std::numbers::pi / 2 + 1e-9 * angle(generator)};
      robot.joints[j].joint.rotation = desk::rotation_of_rpy(
          {angle(generator), near[(static_cast<std::size_t>(i) + j) % 4], angle(generator)});
    }
    const RobotDescription again = back(robot).robot;
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      expect_near(robot.joints[j].joint.rotation, again.joints[j].joint.rotation, 4e-15);
    }
  }
}

TEST(UrdfExport, TiltsTheBaseWhereGravityPullsElsewhere) {
  for (const std::array<double, 3>& gravity :
       {std::array{0.0, 0.0, 9.81}, std::array{9.81, 0.0, 0.0}, std::array{0.0, 5.886, -7.848}}) {
    RobotDescription robot = sample();
    robot.gravity_m_s2 = gravity;
    const auto exported = export_urdf(robot, "arm.toml");
    EXPECT_THAT(exported.changed, Contains(HasSubstr("gravity's direction")));
    expect_near(back(robot).robot.gravity_m_s2, gravity, 1e-12);
  }
}

TEST(UrdfExport, LeavesTheNameThatItNeedsItself) {
  RobotDescription robot = desk::read_robot_file(kRobots / "two_link.toml");
  robot.gravity_m_s2 = {0, -9.81, 0};
  robot.joints[1].name = "world_to_base";
  const auto exported = export_urdf(robot, "robot.toml");
  const ImportedRobot again = import_urdf(exported.text, "again.urdf", {"base", std::nullopt});
  EXPECT_EQ(again.robot.joints.at(1).name, "world_to_base_2");
  EXPECT_THAT(exported.changed, Contains(HasSubstr("the name of joint `world_to_base`: "
                                                   "`world_to_base_2`")));
}

TEST(UrdfExport, NamesWhatItDoesNotCarryInTheResultAndInTheFile) {
  RobotDescription robot = sample();
  robot.gravity_m_s2 = {0, 0, -1.62};
  desk::RobotEffect rotor;
  rotor.kind = EffectKind::kRotorInertia;
  rotor.joint = 1;
  rotor.parameters = {0.3};
  robot.effects.push_back(rotor);
  robot.joints[1].joint.min_position = -std::numeric_limits<double>::max();
  robot.joints[1].joint.max_position = std::numeric_limits<double>::max();
  const auto exported = export_urdf(robot, "arm.toml");
  EXPECT_THAT(exported.not_carried, Contains(HasSubstr("gravity of 1.62 m/s^2")));
  EXPECT_THAT(exported.not_carried, Contains("rotor_inertia of joint `slide` (inertia = 0.3)"));
  EXPECT_THAT(exported.changed, Contains(HasSubstr("`slide` slides from -1000 to 1000 m")));
  EXPECT_THAT(exported.text, HasSubstr("not carried: rotor_inertia of joint `slide`"));
}

TEST(UrdfExport, OfEveryRobotOfTheProjectIsReadAgain) {
  int robots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kRobots)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    const RobotDescription robot = desk::read_robot_file(entry.path());
    EXPECT_EQ(back(robot).robot.joint_count(), robot.joint_count());
    ++robots;
  }
  EXPECT_GE(robots, 4);
}

}  // namespace
}  // namespace offnominal::test
